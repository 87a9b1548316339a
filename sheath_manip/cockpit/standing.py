"""How things stand at the controls: one small value, replaced as a whole and never changed."""

import math
from dataclasses import dataclass
from enum import StrEnum
from typing import Self

from sheath_manip.cockpit.lease import NOBODY, Lease
from sheath_manip.types import Outcome
from sheath_manip.types.operator_input import OperatorInput


class Ending(StrEnum):
    """How a person ends an episode."""

    SUCCESS = "success"
    FAILURE = "failure"
    SAVE = "save"
    DISCARD = "discard"

    @property
    def outcome(self) -> Outcome | None:
        """What the person says that the episode is, if anything."""
        return Outcome(self) if self in (Ending.SUCCESS, Ending.FAILURE) else None


@dataclass(frozen=True, eq=False)
class Standing:
    """Everything that people's orders have come to so far, and who drives."""

    operated: bool
    """whether a person may drive this run at all"""
    lease: Lease = NOBODY
    abandoned: bool = False
    """whether who drove was lost or stopped, and nobody has said since who goes on"""
    unready: bool = False
    """whether the run waits for a person before it begins"""
    stops: int = 0
    """emergency stops so far; the newest one has this number"""
    cleared: int = 0
    """the number of the newest one that was reset"""
    halted: bool = False
    """whether the loop was not let on since the last stop: a reset alone does not do that"""
    paused: bool = False
    steps: int = 0
    """single ones that a paused run is still to do"""
    speed: float = 1.0
    episodes: int = 0
    """that have begun so far; the present one has this number"""
    ending: Ending | None = None
    """how the person ends the episode, once it was said"""
    discard_at_s: float | None = None
    """when the episode is to be discarded, unless somebody calls that off; until then all rests"""
    closed: bool = False
    """whether the page is gone, so that nobody will ever answer"""

    def discard_in_s(self, now_s: float) -> int | None:
        """Whole seconds until the episode is discarded; None where it is not to be."""
        return None if self.discard_at_s is None else math.ceil(self.discard_at_s - now_s)

    @property
    def stopped(self) -> bool:
        """Whether there is a stop that nobody has reset."""
        return self.cleared < self.stops

    @property
    def taken(self) -> bool:
        """Whether a person has taken over."""
        return self.lease.holder is not None


@dataclass(frozen=True, eq=False)
class Now:
    """What the control loop goes by in one step."""

    stopped: bool
    taken: bool
    """whether a person has taken over"""
    input: OperatorInput | None
    """of the operator; None where nobody was heard of for too long"""
    abandoned: bool = False
    """whether who had taken over is gone without handing back"""
    halted: bool = False
    """whether nothing may move: stopped, or reset and not yet resumed"""
    ending: Ending | None = None
    closed: bool = False
    touched: bool = False
    """whether who drives has held anything since it took over, or since the episode began"""

    @classmethod
    def of(cls, standing: Standing, operator_input: OperatorInput | None) -> Self:
        """Return what a step goes by where things stand so and the operator's devices say that."""
        return cls(
            standing.stopped,
            standing.taken,
            operator_input,
            standing.abandoned,
            standing.halted,
            standing.ending,
            standing.closed,
            standing.lease.touched,
        )

    @property
    def must_hold(self) -> bool:
        """Whether nobody may act, not even a fallback, until a person says so."""
        return self.halted or self.abandoned or (self.taken and self.input is None)
