"""What viewers draw of the sheet: itself, the circle on it, and the way of the blade so far."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.cutting.locating import Lie
from sheath_manip.tasks.gauze_cutting.cutting.sheet import Sheet
from sheath_manip.tasks.gauze_cutting.geometry import RADIUS_M
from sheath_manip.types import Line, Surface

SHEET_RGB = (0.92, 0.90, 0.84)
TARGET_RGB = (0.08, 0.24, 0.6)
PATH_RGB = (0.85, 0.2, 0.15)
_ABOVE_M = 3e-4
"""the sheet, lest the lines vanish in it"""
_TARGET_POINTS = 73
_MOST_POINTS = 100
"""of the blade's way"""


def surface_of(sheet: Sheet, lie: Lie) -> Surface:
    """The sheet as it lies, with its cut."""
    used = sheet.spares.start
    return Surface(lie.positions_m[:used].astype(np.float32), lie.elements.copy(), SHEET_RGB)


def lines_of(lie: Lie, path_m: NDArray) -> tuple[Line, Line]:
    """The target, and (k, 2) of the blade's way in material coordinates."""
    angles = np.linspace(0, 2 * np.pi, _TARGET_POINTS)
    target = RADIUS_M * np.column_stack([np.cos(angles), np.sin(angles)])
    chosen = np.unique(np.linspace(0, len(path_m) - 1, _MOST_POINTS).astype(int))
    return (
        Line(_lifted(lie, target), TARGET_RGB),
        Line(_lifted(lie, path_m[chosen]), PATH_RGB),
    )


def _lifted(lie: Lie, material_m: NDArray) -> NDArray[np.float32]:
    """(k, 3) of (k, 2) points of the sheet, in the world."""
    places = lie.positions_of(material_m)
    places[:, 2] += _ABOVE_M
    return places.astype(np.float32)
