"""A person's hands on an arm: all devices together become one twist and one grip."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.teleop import keys
from sheath_manip.controllers.teleop.gizmo import pose_of
from sheath_manip.controllers.teleop.together import Together
from sheath_manip.types import Action
from sheath_manip.types.operator_input import OperatorInput


class ArmHands:
    """Drives a tool whose action begins with a twist and, with a gripper, ends with its grip.

    What the command filter makes of it is the filter's; so a hand-over is no jump.
    """

    dead_man = True
    planar = False
    guide = keys.GUIDE

    def __init__(
        self,
        tool_pose: Callable[[], NDArray[np.float64]],
        rest: Callable[[], Action],
        twist_scale: NDArray,
    ) -> None:
        """`tool_pose` gives the (4, 4) pose of the tool now, world frame.

        `rest` gives the (a,) action that leaves everything as it is, whose first six entries are a
        twist in shares of `twist_scale` (6,) (m/s, rad/s).
        """
        self._tool_pose = tool_pose
        self._rest = rest
        self._devices = Together(tool_pose, twist_scale)

    def action(self, operator_input: OperatorInput) -> Action:
        """(a,) the devices' sum, within the bounds; what they leave open stays as it is."""
        action = self._rest()
        motion = self._devices.motion(operator_input)
        action[:6] = motion.twist
        if motion.grip is not None and len(action) > 6:
            action[6] = motion.grip
        return action

    def tool_pose(self) -> NDArray[np.float64]:
        """(7,) where the gizmo belongs."""
        return pose_of(self._tool_pose())
