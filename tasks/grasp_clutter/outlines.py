"""Where the clutter's outlines are, from the poses of its bodies."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.grasp_clutter.objects import Cuboid, StandingObject

_POINTS = 16
"""around a foot or a top"""


class Outlines:
    """Points around foot and top of the objects of one scene."""

    def __init__(self, objects: tuple[StandingObject, ...]) -> None:
        rings = [
            [_ring(part, height) for part in each.parts for height in (part.bottom_m, part.top_m)]
            for each in objects
        ]
        counts = [_POINTS * len(ring) for ring in rings]
        self._owners = np.repeat(np.arange(len(objects)), counts)
        self._points_in_body = np.concatenate([points for ring in rings for points in ring])
        self._heights = np.array([each.height_m for each in objects])

    def at(
        self, positions_m: NDArray, rotations: NDArray
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(p, 2) points and (p,) heights of their objects' tops, both m, world frame.

        For bodies at (n, 3) `positions_m` with (n, 3, 3) `rotations`.
        """
        turned = np.einsum("pij,pj->pi", rotations[self._owners], self._points_in_body)
        tops = positions_m[:, 2] + rotations[:, 2, 2] * self._heights
        return turned[:, :2] + positions_m[self._owners, :2], tops[self._owners]


def _ring(part: Cuboid, height_m: float) -> NDArray[np.float64]:
    """(16, 3) points on the outline of `part`, in the body's frame."""
    angles = np.linspace(0, 2 * np.pi, _POINTS, endpoint=False)
    around = np.stack([np.cos(angles), np.sin(angles)], 1)
    if not part.round:
        # Onto the square around the circle, corners included.
        around = around / np.abs(around).max(axis=1, keepdims=True)
    around = around * [part.half_x_m, part.half_y_m]
    return np.concatenate([around, np.full((_POINTS, 1), height_m)], axis=1)
