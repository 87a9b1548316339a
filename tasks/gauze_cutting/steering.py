"""What an action says of the blade's velocity in the plane."""

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import Action, ActionSpec

TOP_SPEED_M_S = 0.03
"""along an axis"""
TOP_TURN_RAD = 0.5
"""in a control step: half as much again as the blade could turn around a corner"""


class Steering(ABC):
    """An action space. Velocities and headings are (2,) in the world frame; headings are 1 long."""

    action: ActionSpec
    vector: tuple[str, str] | tuple[()]
    """dimensions of an action that are a vector in the world frame"""

    @abstractmethod
    def velocity_m_s(self, action: NDArray, heading: NDArray) -> NDArray[np.float64]:
        """(2,) that (a,) `action` asks of a blade with that heading."""

    @abstractmethod
    def action_for(self, velocity_m_s: NDArray, heading: NDArray) -> Action:
        """(a,) that comes nearest to asking for that velocity."""


class PlanarVelocity(Steering):
    """Both components of the velocity."""

    action = ActionSpec(
        names=("velocity_x", "velocity_y"),
        minimum=-np.ones(2, np.float32),
        maximum=np.ones(2, np.float32),
        tolerance=0.1,
    )
    """as shares of `TOP_SPEED_M_S`"""
    vector = ("velocity_x", "velocity_y")

    def velocity_m_s(self, action: NDArray, heading: NDArray) -> NDArray[np.float64]:  # noqa: ARG002
        """Return the velocity in proportion."""
        return TOP_SPEED_M_S * np.asarray(action, np.float64)

    def action_for(self, velocity_m_s: NDArray, heading: NDArray) -> Action:  # noqa: ARG002
        """Return the action in proportion, each component by itself within its bounds."""
        return np.clip(velocity_m_s / TOP_SPEED_M_S, -1.0, 1.0).astype(np.float32)


class HeadingChange(Steering):
    """A change of heading: how fast, and how much to turn from where the blade is heading."""

    action = ActionSpec(
        names=("speed", "turn"),
        minimum=np.array([0.0, -1.0], np.float32),
        maximum=np.ones(2, np.float32),
        tolerance=0.1,
    )
    """as shares of `TOP_SPEED_M_S`, and of `TOP_TURN_RAD`, to the left"""
    vector = ()

    def velocity_m_s(self, action: NDArray, heading: NDArray) -> NDArray[np.float64]:
        """Return the velocity along the turned heading."""
        speed, turn = (float(value) for value in action)
        cos, sin = np.cos(turn * TOP_TURN_RAD), np.sin(turn * TOP_TURN_RAD)
        return TOP_SPEED_M_S * speed * (np.array([[cos, -sin], [sin, cos]]) @ heading)

    def action_for(self, velocity_m_s: NDArray, heading: NDArray) -> Action:
        """Return the action at its speed, in its direction as far as one may turn."""
        along = float(heading @ velocity_m_s)
        across = float(heading[0] * velocity_m_s[1] - heading[1] * velocity_m_s[0])
        turn = np.arctan2(across, along) / TOP_TURN_RAD
        speed = float(np.linalg.norm(velocity_m_s)) / TOP_SPEED_M_S
        return np.clip([speed, turn], self.action.minimum, self.action.maximum).astype(np.float32)


PLANAR_VELOCITY = PlanarVelocity()
HEADING_CHANGE = HeadingChange()
