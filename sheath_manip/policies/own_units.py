"""Scaling of features in units that have nothing to do with each other, as metres and newtons."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.scaling import Standardisation

LEAST_OF_SIZE = 0.01
"""of a feature's own largest value: what moves by less, such as a gripper that stayed open, is not
blown up by its own jitter"""
LEAST = 1e-6
"""in any unit"""


class OwnUnits(Standardisation):
    """Zero mean and unit standard deviation, with a floor for each feature that is its own.

    The floor of `Standardisation` follows the median feature: beside forces of 50 N, places to the
    millimetre would be lost.
    """

    def _floor(self, X: NDArray, deviations: NDArray) -> NDArray:
        floors = np.maximum(LEAST_OF_SIZE * np.abs(X).max(axis=0), LEAST)
        # One that never moved has no unit.
        return np.where(deviations > 0, floors, 1.0)
