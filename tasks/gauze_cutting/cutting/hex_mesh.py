"""A square of nearly equilateral triangles."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError


@dataclass(frozen=True, eq=False)
class Mesh:
    """A triangulated sheet in material coordinates."""

    points_m: NDArray[np.float64]
    """(n, 2)"""
    triangles: NDArray[np.int32]
    """(t, 3) rows of `points_m`, counter-clockwise"""
    size_m: float
    """length of an edge, about"""


def hex_square(side_m: float, columns: int) -> Mesh:
    """A square around the origin; every other row is shifted by half a triangle.

    Raises ParameterError for fewer than 3 vertices a row.
    """
    if columns < 3 or side_m <= 0:
        raise ParameterError(
            f"{columns} columns over {side_m} m; wanted 3 or more over some length"
        )
    size_m = side_m / (columns - 1)
    # An odd number of rows, so that the last is like the first and the square is symmetric.
    rows = 2 * round(side_m / (size_m * np.sqrt(3) / 2) / 2) + 1
    straight = np.linspace(0.0, side_m, columns)
    shifted = np.concatenate([[0.0], straight[:-1] + size_m / 2, [side_m]])
    heights = np.linspace(0.0, side_m, rows)
    lines = [straight if row % 2 == 0 else shifted for row in range(rows)]
    points = np.concatenate(
        [np.column_stack([xs, np.full(len(xs), y)]) for xs, y in zip(lines, heights, strict=True)]
    )
    triangles, first = [], 0
    for below, above in pairwise(lines):
        triangles += _strip(below, above, first)
        first += len(below)
    return Mesh(points - side_m / 2, np.array(triangles, np.int32), size_m)


def _strip(below: NDArray, above: NDArray, first: int) -> list[tuple[int, int, int]]:
    """Triangles between two rows of which the lower one starts at vertex `first`."""
    low, high, triangles = 0, 0, []
    start = first + len(below)
    while low + 1 < len(below) or high + 1 < len(above):
        ends = high + 1 == len(above)
        if ends or (low + 1 < len(below) and below[low + 1] <= above[high + 1]):
            triangles.append((first + low, first + low + 1, start + high))
            low += 1
        else:
            triangles.append((first + low, start + high + 1, start + high))
            high += 1
    return triangles
