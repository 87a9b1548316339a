"""A person's hands on an arm: all devices together become one twist and one grip."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from controllers.teleop import keys
from controllers.teleop.device import Device
from controllers.teleop.gamepad import GamepadDevice
from controllers.teleop.gizmo import Gizmo, pose_of
from controllers.teleop.keys import Keys
from controllers.teleop.six_axes import SixAxesDevice
from sheath_manip.cockpit.given import Given
from sheath_manip.types import Action


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
        devices: Sequence[Device] | None = None,
    ) -> None:
        """`tool_pose` gives the (4, 4) pose of the tool now, world frame.

        `rest` gives the (a,) action that leaves everything as it is, whose first six entries are a
        twist in shares of `twist_scale` (6,) (m/s, rad/s).
        """
        self._tool_pose = tool_pose
        self._rest = rest
        self.devices = devices or (
            Keys(),
            Gizmo(tool_pose, twist_scale),
            GamepadDevice(),
            SixAxesDevice(),
        )

    def action(self, given: Given) -> Action:
        """(a,) the devices' sum, within the bounds; what they leave open stays as it is."""
        action = self._rest()
        motions = [device.motion(given) for device in self.devices]
        held = [motion for motion in motions if motion.dead_man]
        twist = sum((motion.twist for motion in held), np.zeros(6))
        action[:6] = np.clip(np.nan_to_num(twist), -1.0, 1.0)
        grips = [motion.grip for motion in held if motion.grip is not None]
        if grips and len(action) > 6:
            action[6] = grips[0]
        return action

    def tool_pose(self) -> NDArray[np.float64]:
        """(7,) where the gizmo belongs."""
        return pose_of(self._tool_pose())
