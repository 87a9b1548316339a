"""What is said to a robot's process: each is a small value, and knows what it does to the cockpit.

Times are of `time.monotonic`, which is one clock for all processes of a machine.
"""

import time
from dataclasses import dataclass
from typing import Protocol

from numpy.typing import NDArray

from sheath_manip.cockpit import Cockpit, OperatorInput, Order, SixAxes
from sheath_manip.cockpit.shown import NOTHING, Shown


class ToRobot(Protocol):
    """One message; what is lost on its way, or late, leaves the robot holding."""

    def act_on(self, cockpit: Cockpit) -> None:
        """Tell the robot's own cockpit."""
        ...


@dataclass(frozen=True)
class Ordered:
    """An order of a station, which may give it; None is the program."""

    order: Order
    station: str | None
    value: float = 1.0
    shown: Shown = NOTHING

    def act_on(self, cockpit: Cockpit) -> None:
        """Order it there, where it may still be void: the robot has the last word."""
        cockpit.order(self.order, self.station, self.value, self.shown)


@dataclass(frozen=True, eq=False)
class Held:
    """What a station held at a moment; a heartbeat, too."""

    station: str
    input: OperatorInput
    at_s: float

    def act_on(self, cockpit: Cockpit) -> None:
        """Submit it there, as old as it is by now."""
        age_s = max(0.0, time.monotonic() - self.at_s)
        cockpit.submit_input(self.station, self.input, age_s)


@dataclass(frozen=True, eq=False)
class Dragged:
    """Where a station drags the gizmo to, (7,); None once it lets go of it."""

    station: str
    goal: NDArray | None

    def act_on(self, cockpit: Cockpit) -> None:
        """Drag it there."""
        cockpit.drag(self.station, self.goal)


@dataclass(frozen=True, eq=False)
class Turned:
    """What a device says that is plugged in at the page's machine."""

    axes: SixAxes

    def act_on(self, cockpit: Cockpit) -> None:
        """Turn it there."""
        cockpit.turn_axes(self.axes)


@dataclass(frozen=True)
class Silenced:
    """Nothing that a station said counts any longer."""

    station: str

    def act_on(self, cockpit: Cockpit) -> None:
        """Silence it there."""
        cockpit.silence(self.station)


@dataclass(frozen=True)
class Gone:
    """A station is gone."""

    station: str

    def act_on(self, cockpit: Cockpit) -> None:
        """Let it leave there."""
        cockpit.leave(self.station)


@dataclass(frozen=True)
class Closed:
    """The page is gone, and nobody will ever answer."""

    def act_on(self, cockpit: Cockpit) -> None:
        """Close the robot's cockpit."""
        cockpit.close()
