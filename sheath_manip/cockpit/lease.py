"""One operator at a time: the right to drive, kept by a heartbeat, and what its holder holds."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types.operator_input import EMPTY, OperatorInput, SixAxes

LOST_AFTER_S = 0.4
"""without a heartbeat the operator's input counts as empty; with a control period of .1 s on top
the robot holds within half a second"""
FREE_AFTER_S = 3.0
"""without a heartbeat another one may take over: a page that reloads gets its own turn back"""


@dataclass(frozen=True, eq=False)
class Axes:
    """What a device says that is plugged in here, and at no station."""

    at_s: float
    """when it said so, by the cockpit's clock"""
    axes: SixAxes


@dataclass(frozen=True, eq=False)
class Lease:
    """Who drives, and what was last heard of that one.

    Both are one value, so that what one person held is never the next one's.
    """

    holder: str | None = None
    """the station that drives, None where nobody does"""
    beat_s: float = 0.0
    """when it was last heard of, by the cockpit's clock"""
    input: OperatorInput | None = None
    """what its devices said then; None after a silence that it must break"""
    touched: bool = False
    """whether it has held anything in this turn: before that even a car stands"""
    goal: NDArray[np.float64] | None = None
    """(7,) where it drags the gizmo to, None while it does not"""

    @classmethod
    def begun(cls, station: str, now_s: float) -> Self:
        """`station` has it from now on, and holds nothing yet."""
        return cls(station, now_s, EMPTY)

    def heard(self, operator_input: OperatorInput, at_s: float) -> Self:
        """A sign of life, of `at_s`."""
        touched = self.touched or operator_input.held
        return replace(self, input=operator_input, beat_s=at_s, touched=touched)

    def untouched(self) -> Self:
        """A new turn of the same one, who has held nothing in it yet."""
        return replace(self, touched=False)

    def silenced(self) -> Self:
        """Hold nothing until it is heard again; the right to drive goes on for a while.

        What goes on then begins with a key: not even a car sets off by itself.
        """
        return replace(self, input=None, goal=None, touched=False)

    def alive(self, now_s: float) -> bool:
        """Return whether somebody drives and was heard of a moment ago."""
        return self.input is not None and now_s - self.beat_s <= LOST_AFTER_S

    def everything(self, now_s: float, latest: Axes | None) -> OperatorInput | None:
        """Return what the holder's devices say now, `latest` too; None where nobody is heard of."""
        if self.input is None or not self.alive(now_s):
            return None
        heard = latest is not None and now_s - latest.at_s <= LOST_AFTER_S
        return replace(self.input, goal=self.goal, axes=latest.axes if latest and heard else None)

    def expired(self, now_s: float) -> bool:
        """Return whether the lease's holder was not heard of for so long that it is lost."""
        return self.holder is not None and now_s - self.beat_s > FREE_AFTER_S


NOBODY = Lease()
