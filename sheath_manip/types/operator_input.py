"""What a person's devices say at one moment, before anyone knows what robot it is for."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

DEAD_MAN_BUTTON = 4
"""the left shoulder button in the Gamepad API's standard mapping"""
MOST_KEYS = 12
"""held at once: more than ten fingers are a fault"""


@dataclass(frozen=True)
class Gamepad:
    """A gamepad in the standard mapping of the W3C's Gamepad API."""

    axes: tuple[float, float, float, float]
    """each -1..1: left stick right and down, right stick right and down"""
    buttons: frozenset[int]
    """the pressed ones"""

    @property
    def held(self) -> bool:
        """Whether the device's dead-man's button is pressed."""
        return DEAD_MAN_BUTTON in self.buttons


@dataclass(frozen=True, eq=False)
class SixAxes:
    """A device that springs back to its middle, such as a SpaceMouse."""

    twist: NDArray[np.float64]
    """(6,) each -1..1: along and about x, y, z of the world frame"""
    buttons: tuple[bool, bool] = (False, False)
    """close, open"""

    @property
    def held(self) -> bool:
        """Whether the cap is out of its middle, or a button is pressed."""
        return bool(np.any(self.twist)) or any(self.buttons)


@dataclass(frozen=True, eq=False)
class Given:
    """The input of all of an operator's devices together."""

    keys: frozenset[str] = frozenset()
    """held, as `KeyboardEvent.code` names them"""
    pad: Gamepad | None = None
    goal: NDArray[np.float64] | None = None
    """(7,) position (m) and wxyz quaternion, world frame, of the gizmo while it is dragged"""
    axes: SixAxes | None = None

    @property
    def held(self) -> bool:
        """The dead-man: whether the person holds any device."""
        return (
            bool(self.keys)
            or self.goal is not None
            or (self.pad is not None and self.pad.held)
            or (self.axes is not None and self.axes.held)
        )


EMPTY = Given()


@dataclass(frozen=True)
class Binding:
    """Keys with one purpose."""

    codes: tuple[str, ...]
    """as `KeyboardEvent.code` names them"""
    says: str
    """such as `forward, back`"""

    @property
    def shown(self) -> str:
        """The keys as they are printed on a keyboard."""
        return " ".join(code.removeprefix("Key").removeprefix("Digit") for code in self.codes)
