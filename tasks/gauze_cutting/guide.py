"""How to move along the circle, as someone takes the sheet to lie."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.cutting.locating import Lie
from sheath_manip.tasks.gauze_cutting.geometry import RADIUS_M

SPEED_M_S = 0.02
"""along the line"""
LAG_S = 0.06
"""by which the blade follows the arm's command"""
_AHEAD_S = 0.05
"""one control step"""
_RETURN_HZ = 6.0
"""share of a deviation that is made good in a second"""
_MOST_RETURN_M_S = 0.024
"""towards the line"""


def along_circle(
    lie: Lie, material_m: NDArray, velocity_m_s: NDArray, drift_m_s: NDArray
) -> NDArray[np.float64]:
    """(2,) velocity to ask for, m/s in the world frame.

    The blade is at (2,) `material_m` and moves at (2,) `velocity_m_s` in the world, over a sheet
    that itself moves at (2,) `drift_m_s`. What is commanded now acts once the blade has gone on by
    its lag, so that is where the way is planned from: along the circle and towards it.
    """
    here = lie.of(material_m)
    to_world = _gradient(lie, here.corners)
    ahead = material_m + LAG_S * np.linalg.solve(to_world, velocity_m_s - drift_m_s)
    radius = float(np.linalg.norm(ahead))
    outwards = ahead / max(radius, 1e-6)
    onwards = np.array([-outwards[1], outwards[0]])
    back = float(np.clip(_RETURN_HZ * (RADIUS_M - radius), -_MOST_RETURN_M_S, _MOST_RETURN_M_S))
    # Slower along the line while it has to be reached first.
    along = SPEED_M_S * (1 - 0.7 * abs(back) / _MOST_RETURN_M_S)
    turned = along * _AHEAD_S / RADIUS_M / 2
    direction = np.cos(turned) * onwards - np.sin(turned) * outwards
    return to_world @ (along * direction + back * outwards) + drift_m_s


def _gradient(lie: Lie, corners: NDArray) -> NDArray[np.float64]:
    """(2, 2) from material to world of one element, seen from above."""
    material = lie.material_m[corners]
    world = lie.positions_m[corners, :2]
    return np.linalg.solve(material[1:] - material[0], world[1:] - world[0]).T
