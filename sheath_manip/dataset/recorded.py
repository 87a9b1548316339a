"""An episode as it is stored: its header and its arrays."""

from dataclasses import dataclass

from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import Arrays


@dataclass(frozen=True, eq=False)
class Recorded:
    """One episode by column instead of by step, which is how files of all formats hold it."""

    header: Header
    arrays: Arrays
    """those of `layout(header)`"""
