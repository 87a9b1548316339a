"""An arm by a gizmo in the 3-D scene: the tool goes where it is dragged to."""

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.teleop.device import NOTHING, Motion
from sheath_manip.controllers.twist_control import twist_between
from sheath_manip.types.operator_input import Given

_CATCH_UP_S = 0.25
"""in which the tool would reach the gizmo, if it may go that fast"""


class Gizmo:
    """Drags the tool along; letting go of the gizmo lets go of the dead-man."""

    def __init__(self, tool_pose: Callable[[], NDArray[np.float64]], twist_scale: NDArray) -> None:
        """`tool_pose` gives the (4, 4) pose of the tool now, world frame; `twist_scale` (6,)."""
        self._tool_pose = tool_pose
        self._twist_scale = np.array(twist_scale, float)

    def motion(self, given: Given) -> Motion:
        """Towards the gizmo, its direction kept where it cannot go as fast as wished."""
        if given.goal is None:
            return NOTHING
        twist = twist_between(self._tool_pose(), transform_of(given.goal), _CATCH_UP_S)
        shares = twist / self._twist_scale
        # Way and turn apart, so that a large turn does not slow down the way.
        for part in (shares[:3], shares[3:]):
            part /= max(1.0, float(np.abs(part).max()))
        return Motion(shares, None, dead_man=True)


def transform_of(pose: NDArray) -> NDArray[np.float64]:
    """Return the (4, 4) of (7,) position and wxyz quaternion, which need not be a unit."""
    rotation, quaternion = np.zeros(9), np.array(pose[3:], np.float64)
    mujoco.mju_normalize4(quaternion)
    mujoco.mju_quat2Mat(rotation, quaternion)
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = rotation.reshape(3, 3), pose[:3]
    return transform


def pose_of(transform: NDArray) -> NDArray[np.float64]:
    """(7,) position and unit wxyz quaternion of a (4, 4) transform."""
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(transform[:3, :3]).ravel())
    return np.concatenate([transform[:3, 3], quaternion])
