"""How fast a tool may move near what it must not bump into."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError

Distance = Callable[[NDArray[np.float64]], float]
"""(3,) point (m, world frame) → how far it is (m) from the nearest thing to be careful of"""


@dataclass(frozen=True)
class SpeedCap:
    """A speed cap: slow within `near_m`, free beyond `far_m`, and linear in between."""

    distance_m: Distance
    name: str = "speed near clutter"
    slow_m_s: float = 0.12
    fast_m_s: float = 0.3
    near_m: float = 0.03
    far_m: float = 0.12

    def __post_init__(self) -> None:
        if not (0 < self.slow_m_s <= self.fast_m_s and 0 <= self.near_m < self.far_m):
            raise ParameterError(
                f"speeds {self.slow_m_s} and {self.fast_m_s} m/s within {self.near_m} and beyond "
                f"{self.far_m} m; wanted 0 < slow <= fast and 0 <= near < far"
            )

    def most_m_s(self, point_m: NDArray) -> float:
        """The most that a tool at (3,) `point_m` may have; infinite far away."""
        distance_m = self.distance_m(point_m)
        if distance_m >= self.far_m:
            return float("inf")
        share = max(0.0, (distance_m - self.near_m) / (self.far_m - self.near_m))
        return self.slow_m_s + share * (self.fast_m_s - self.slow_m_s)


def above(height_m: float) -> Distance:
    """Distance from a level surface, such as a table."""
    return lambda point_m: max(0.0, float(point_m[2]) - height_m)


def from_standing(objects: Callable[[], NDArray[np.float64]]) -> Distance:
    """Distance from standing objects: (n, 5) of x, y, foot z, radius and height (m), upright."""

    def distance_m(point_m: NDArray[np.float64]) -> float:
        standing = objects()
        if not len(standing):
            return float("inf")
        aside = np.hypot(*(standing[:, :2] - point_m[:2]).T) - standing[:, 3]
        below = standing[:, 2] - point_m[2]
        over = -below - standing[:, 4]
        upright = np.maximum(np.maximum(below, over), 0.0)
        return float(np.hypot(np.maximum(aside, 0.0), upright).min())

    return distance_m
