"""A person's hands on a tool that moves in a plane: all devices together become one velocity."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.teleop import keys
from sheath_manip.controllers.teleop.together import Together
from sheath_manip.types import Action
from sheath_manip.types.operator_input import Given


class PlanarHands:
    """Takes the way along the plane from what devices ask for.

    Depth and tilt are the task's own.
    """

    dead_man = True
    planar = True
    guide = keys.PLANAR_GUIDE

    def __init__(
        self,
        tool_pose: Callable[[], NDArray[np.float64]],
        action_for: Callable[[NDArray[np.float64]], Action],
        top_speed_m_s: float,
    ) -> None:
        """`tool_pose` gives the (4, 4) pose of the tool now, world frame.

        `action_for` gives the (a,) action that asks for a (2,) velocity, m/s in the world frame,
        each component of which is at most `top_speed_m_s`.
        """
        self._tool_pose = tool_pose
        self._action_for = action_for
        self._top_speed_m_s = top_speed_m_s
        # A gizmo that is dragged out of the plane or turned asks for nothing there.
        scale = np.array([top_speed_m_s, top_speed_m_s, *[np.inf] * 4])
        self._devices = Together(tool_pose, scale)

    def action(self, given: Given) -> Action:
        """(a,) the devices' sum, within the bounds."""
        return self._action_for(self._top_speed_m_s * self._devices.motion(given).twist[:2])

    def tool_pose(self) -> NDArray[np.float64]:
        """(7,) where the gizmo belongs, its axes the world's."""
        return np.array([*self._tool_pose()[:3, 3], 1.0, 0.0, 0.0, 0.0])
