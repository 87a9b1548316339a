"""Moves a vertex of the mesh in material coordinates, before a cut runs through it."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.cutting.sheet import Sheet

LEAST_QUALITY = 0.12
"""of a triangle: 1 is equilateral; below a tenth the stiffness has edges that differ too much"""


def quality(corners_m: NDArray) -> NDArray[np.float64]:
    """Return the (n,) quality of (n, 3, 2) triangles: 1 equilateral, 0 flat, < 0 turned over."""
    a, b, c = corners_m.transpose(1, 0, 2)
    first, second = b - a, c - a
    doubled_area = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
    squares = ((b - a) ** 2 + (c - b) ** 2 + (a - c) ** 2).sum(axis=1)
    return 2 * np.sqrt(3) * doubled_area / squares


def may_snap(sheet: Sheet, vertex: int, point_m: NDArray) -> bool:
    """Return whether `vertex` is free to move to (2,) `point_m` and no element becomes a sliver."""
    if sheet.pinned[vertex] or sheet.on_rim(vertex):
        return False
    around = sheet.elements[sheet.elements_at(vertex)]
    corners = np.where((around == vertex)[..., None], point_m, sheet.rest_m[around])
    return bool(quality(corners).min() >= LEAST_QUALITY)


def snap(sheet: Sheet, vertex: int, point_m: NDArray) -> None:
    """Let `vertex` be the material point (2,) `point_m`; its mass stays."""
    moved = point_m - sheet.rest_m[vertex]
    sheet.rest_m[vertex] = point_m
    if sheet.texture is not None:
        # The picture lies on the sheet as texture coordinates say: linear in the material's.
        low, high = sheet.mesh.points_m.min(axis=0), sheet.mesh.points_m.max(axis=0)
        sheet.texture[vertex] += moved / (high - low)
    sheet.recompute(sheet.elements_at(vertex))
