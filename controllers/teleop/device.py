"""What a device asks of an arm: one protocol for keys, gizmo, gamepad and SpaceMouse."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types.operator_input import Given


@dataclass(frozen=True, eq=False)
class Motion:
    """The motion that a device asks for now."""

    twist: NDArray[np.float64]
    """(6,) velocity and angular velocity of the tool, world frame, shares -1..1 of the fastest"""
    grip: float | None
    """-1 opens, 1 closes, None leaves the gripper as it is"""
    dead_man: bool
    """whether a person holds the device: else nothing of it counts"""


class Device(Protocol):
    """Reads one device out of all that a person's devices say."""

    def motion(self, given: Given) -> Motion:
        """Return what the device says; of any input, since the page may send anything."""
        ...


NOTHING = Motion(np.zeros(6), None, dead_man=False)


def grip_of(close: bool, open: bool) -> float | None:
    """The grip of two buttons; both at once leave the gripper as it is."""
    return None if close == open else (1.0 if close else -1.0)
