"""An arm by a gamepad: the sticks move while the left shoulder button is held."""

import numpy as np

from sheath_manip.controllers.teleop.device import NOTHING, Motion, grip_of
from sheath_manip.types.operator_input import OperatorInput

DEAD_ZONE = 0.1
"""of a stick's way, within which a worn one comes to rest"""
_CLOSE, _OPEN, _TILT = 0, 1, 5
"""A, B and the right shoulder button of the standard mapping"""


class GamepadDevice:
    """Left stick: along the table. Right stick: up and about z; with the right shoulder: tilt."""

    def motion(self, operator_input: OperatorInput) -> Motion:
        """Sticks and buttons; nothing while the dead-man's button is not held."""
        pad = operator_input.pad
        if pad is None or not pad.held:
            return NOTHING
        left_right, left_down, right_right, right_down = (_beyond(axis) for axis in pad.axes)
        twist = np.zeros(6)
        twist[:2] = -left_down, -left_right
        if _TILT in pad.buttons:
            twist[3:5] = right_right, -right_down
        else:
            twist[[2, 5]] = -right_down, -right_right
        return Motion(twist, grip_of(_CLOSE in pad.buttons, _OPEN in pad.buttons), dead_man=True)


def _beyond(axis: float) -> float:
    """The stick's way beyond its dead zone, -1..1."""
    way = max(0.0, abs(axis) - DEAD_ZONE) / (1 - DEAD_ZONE)
    return float(np.copysign(min(way, 1.0), axis))
