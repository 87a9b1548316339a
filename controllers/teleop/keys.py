"""An arm by held keys; none of them flies viser's camera (W A S D Q E, arrows)."""

import numpy as np

from sheath_manip.controllers.teleop.device import Motion, grip_of
from sheath_manip.types.operator_input import Binding, OperatorInput

_MOVES = {
    "KeyI": (0, 1.0),
    "KeyK": (0, -1.0),
    "KeyJ": (1, 1.0),
    "KeyL": (1, -1.0),
    "KeyU": (2, 1.0),
    "KeyO": (2, -1.0),
    "Digit1": (3, 1.0),
    "Digit2": (3, -1.0),
    "Digit3": (4, 1.0),
    "Digit4": (4, -1.0),
    "Digit5": (5, 1.0),
    "Digit6": (5, -1.0),
}
"""by key: the entry of the twist and its sign"""
SPEED, FINE_SPEED = 0.6, 0.15
"""shares of the fastest command"""
_CLOSE, _OPEN, _FINE = "KeyN", "KeyM", "KeyB"
PLANAR_GUIDE = (
    Binding(("KeyI", "KeyK"), "forward, back"),
    Binding(("KeyJ", "KeyL"), "left, right"),
    Binding((_FINE,), "slowly, while held"),
)
GUIDE = (
    *PLANAR_GUIDE[:2],
    Binding(("KeyU", "KeyO"), "up, down"),
    Binding(("Digit1", "Digit2"), "turn about x"),
    Binding(("Digit3", "Digit4"), "turn about y"),
    Binding(("Digit5", "Digit6"), "turn about z"),
    Binding((_CLOSE, _OPEN), "close, open"),
    PLANAR_GUIDE[-1],
)


class Keys:
    """A held key moves at one speed, and so is the dead-man as well."""

    def __init__(self, speed: float = SPEED, fine_speed: float = FINE_SPEED) -> None:
        """Speeds as shares of the fastest command; the second one while the fine key is held."""
        self.speed = speed
        self.fine_speed = fine_speed

    def motion(self, operator_input: OperatorInput) -> Motion:
        """The sum of the held keys."""
        twist = np.zeros(6)
        held = operator_input.keys & _MOVES.keys()
        for key in held:
            entry, sign = _MOVES[key]
            twist[entry] += sign
        twist *= self.fine_speed if _FINE in operator_input.keys else self.speed
        grip = grip_of(_CLOSE in operator_input.keys, _OPEN in operator_input.keys)
        return Motion(twist, grip, dead_man=bool(held) or grip is not None)
