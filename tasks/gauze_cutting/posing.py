"""Holds the tool at its depth and upright, and puts it somewhere."""

import mink
import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.twist_control import TwistControl

_GAIN_HZ = 4.0
_MOST_STEPS = 12
_CLOSE = 1e-5
"""m and rad"""


def planar_twist(
    velocity_m_s: NDArray,
    transform_tool_to_world: NDArray,
    height_m: float,
    rotation: NDArray,
) -> NDArray[np.float64]:
    """(6,) m/s and rad/s, world frame.

    (2,) `velocity_m_s` in the plane; the tool, now at a (4, 4) pose, is held at `height_m` and at
    (3, 3) `rotation`.
    """
    turn = mink.SO3.from_matrix(rotation @ transform_tool_to_world[:3, :3].T).log()
    climb = _GAIN_HZ * (height_m - transform_tool_to_world[2, 3])
    return np.concatenate([velocity_m_s, [climb], _GAIN_HZ * turn])


def joints_for(
    control: TwistControl, start_rad: NDArray, position_m: NDArray, rotation: NDArray
) -> NDArray[np.float64]:
    """(j,) joints that put the tool at (3,) `position_m` and (3, 3) `rotation`.

    `control` is asked for one step after another from (j,) `start_rad`.
    """
    joints = np.array(start_rad, float)
    for _ in range(_MOST_STEPS):
        pose = control.transform_tool_to_world(joints)
        turn = mink.SO3.from_matrix(rotation @ pose[:3, :3].T).log()
        error = np.concatenate([position_m - pose[:3, 3], turn])
        if np.abs(error).max() < _CLOSE:
            return joints
        joints = control.joint_targets(joints, error / control.timestep_s)
    return joints
