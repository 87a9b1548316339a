"""A person's hands on a game or a car: a few buttons, on the keyboard or on a gamepad."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from sheath_manip.types import Action
from sheath_manip.types.operator_input import Binding, Given

STICK = 0.5
"""of its way, from which on a stick counts as a button"""


@dataclass(frozen=True)
class Button:
    """A button, and what presses it."""

    key: str
    """`KeyboardEvent.code`"""
    says: str
    pad: int | None = None
    """of a gamepad's buttons"""
    stick: int = 0
    """-1 or 1: which way of a gamepad's left stick, left or right"""

    def pressed(self, given: Given) -> bool:
        """Return whether the button is pressed."""
        if self.key in given.keys:
            return True
        pad = given.pad
        if pad is None:
            return False
        return self.pad in pad.buttons or (self.stick != 0 and pad.axes[0] * self.stick > STICK)


class ButtonHands:
    """Letting go is an action too, so there is no dead-man: going straight on, standing still."""

    dead_man = False
    planar = False

    def __init__(
        self,
        buttons: Mapping[str, Button],
        action_of: Callable[[frozenset[str]], Action],
    ) -> None:
        """`action_of` gives the (a,) action of the names of `buttons` that are pressed."""
        self._buttons = dict(buttons)
        self._action_of = action_of
        self.guide = tuple(Binding((button.key,), button.says) for button in buttons.values())

    def action(self, given: Given) -> Action:
        """Return the (a,) action of the buttons that are pressed."""
        pressed = (name for name, button in self._buttons.items() if button.pressed(given))
        return np.asarray(self._action_of(frozenset(pressed)), np.float32)

    def tool_pose(self) -> None:
        """Return None: there is nothing to drag."""
