"""Puts a tool somewhere: the joints for a pose, by steps of differential inverse kinematics."""

import mink
import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.twist_control import TwistControl

_MOST_STEPS = 12
_CLOSE = 1e-5
"""m and rad"""


def joints_for(
    control: TwistControl,
    start_rad: NDArray,
    position_m: NDArray,
    rotation: NDArray,
    most_steps: int = _MOST_STEPS,
) -> NDArray[np.float64]:
    """(j,) joints that put the tool at (3,) `position_m` and (3, 3) `rotation`.

    `control` is asked for one step after another from (j,) `start_rad`.
    """
    joints = np.array(start_rad, float)
    for _ in range(most_steps):
        pose = control.transform_tool_to_world(joints)
        turn = mink.SO3.from_matrix(rotation @ pose[:3, :3].T).log()
        error = np.concatenate([position_m - pose[:3, 3], turn])
        if np.abs(error).max() < _CLOSE:
            return joints
        joints = control.joint_targets(joints, error / control.timestep_s)
    return joints
