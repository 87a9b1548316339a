"""What can be wrong with a stored episode."""

from dataclasses import dataclass
from enum import StrEnum

from sheath_manip.exceptions import StoreError

REMEDY = "take it out with `sheath data drop` and record the episode again"
"""for whatever is damaged: an episode is replayable from its seed, or one of many"""


class FaultKind(StrEnum):
    """The ways in which a part of a store can be wrong."""

    LEFTOVER = "leftover"
    """a recording in progress, or one that was cut off; harmless"""
    FOREIGN = "foreign"
    """not written by this project"""
    SCHEMA = "schema"
    """written under another schema version"""
    MISSING = "missing"
    """an array or a chunk of it is not there"""
    MISMATCH = "mismatch"
    """a length, shape, type or name contradicts the episode's header"""
    UNREADABLE = "unreadable"
    """it does not decode"""
    NOT_FINITE = "not finite"
    """an action holds NaN or infinity"""
    ODD_FILE = "no plain file"
    """a link, a fifo or the like, or a file larger than any of an episode: not followed or read"""
    REMARK = "remark"
    """as it was recorded, but worth to be known; harmless"""


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong in a store."""

    name: str
    """the entry of the store, usually an episode"""
    kind: FaultKind
    text: str
    """what was wanted, what is there, what helps"""

    @property
    def damaging(self) -> bool:
        """Whether data is affected; a leftover only takes space."""
        return self.kind not in (FaultKind.LEFTOVER, FaultKind.REMARK)

    def __str__(self) -> str:
        return f"{self.name}: {self.text}"


class FaultError(StoreError):
    """A fault met while reading."""

    def __init__(self, name: str, kind: FaultKind, text: str) -> None:
        self.fault = Fault(name, kind, text)
        super().__init__(str(self.fault))
