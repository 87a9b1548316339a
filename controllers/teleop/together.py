"""All devices that a person may hold, as one."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.teleop.device import Device, Motion
from sheath_manip.controllers.teleop.gamepad import GamepadDevice
from sheath_manip.controllers.teleop.gizmo import Gizmo
from sheath_manip.controllers.teleop.keys import Keys
from sheath_manip.controllers.teleop.six_axes import SixAxesDevice
from sheath_manip.types.operator_input import Given


class Together:
    """Keys, gizmo, gamepad and SpaceMouse add up; of a grip the first one counts."""

    def __init__(self, tool_pose: Callable[[], NDArray[np.float64]], twist_scale: NDArray) -> None:
        """`tool_pose` gives the (4, 4) pose of the tool now, world frame.

        `twist_scale` (6,) is the fastest twist, m/s and rad/s.
        """
        self.devices: tuple[Device, ...] = (
            Keys(),
            Gizmo(tool_pose, twist_scale),
            GamepadDevice(),
            SixAxesDevice(),
        )

    def motion(self, given: Given) -> Motion:
        """Return the sum of the devices that are held, finite and within the shares."""
        motions = (device.motion(given) for device in self.devices)
        held = [motion for motion in motions if motion.dead_man]
        twist = sum((motion.twist for motion in held), np.zeros(6))
        grips = [motion.grip for motion in held if motion.grip is not None]
        return Motion(
            np.clip(np.nan_to_num(twist), -1.0, 1.0),
            grips[0] if grips else None,
            dead_man=bool(held),
        )
