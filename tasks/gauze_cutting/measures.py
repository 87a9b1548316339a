"""How well a circle was cut out."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.cutting.pieces import area_in_circle_m2, area_m2
from sheath_manip.tasks.gauze_cutting.cutting.sheet import Sheet

SECTORS = 72
SECTOR_TOLERANCE_M = 0.001


@dataclass(frozen=True)
class PathMeasures:
    """Measures of the blade's path in material coordinates."""

    deviation_m: float
    """from the circle, mean"""
    largest_deviation_m: float
    covered: float
    """share of sectors of 5 degrees in which it came within a millimetre of the line"""


def path_measures(path_m: NDArray, radius_m: float) -> PathMeasures:
    """Return the measures of (k, 2) points around 0."""
    deviations = np.abs(np.linalg.norm(path_m, axis=1) - radius_m)
    angles = np.arctan2(path_m[:, 1], path_m[:, 0])
    sectors = ((angles + np.pi) / (2 * np.pi) * SECTORS).astype(int) % SECTORS
    covered = np.unique(sectors[deviations < SECTOR_TOLERANCE_M])
    return PathMeasures(float(deviations.mean()), float(deviations.max()), len(covered) / SECTORS)


def overlap(sheet: Sheet, disc: NDArray | None, radius_m: float) -> tuple[float, float]:
    """Symmetric difference (m²) between a piece and the circle, and intersection over union."""
    circle = np.pi * radius_m**2
    if disc is None:
        return circle, 0.0
    shared = area_in_circle_m2(sheet, disc, np.zeros(2), radius_m)
    union = circle + area_m2(sheet, disc) - shared
    return union - shared, shared / union
