"""Holds the tool at its depth and upright."""

import mink
import numpy as np
from numpy.typing import NDArray

_GAIN_HZ = 4.0


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
