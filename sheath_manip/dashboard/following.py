"""The switch by which the view goes along with the tool."""

from dataclasses import dataclass


@dataclass
class Following:
    """Set by the page, read by the scene."""

    on: bool
