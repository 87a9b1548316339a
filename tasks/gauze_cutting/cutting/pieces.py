"""What of a sheet hangs together, and the shape of what has come free."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from sheath_manip.tasks.gauze_cutting.cutting.sheet import Sheet


def piece_of_elements(sheet: Sheet) -> NDArray[np.int64]:
    """(t,) number of the piece that each element belongs to, from 0 on."""
    active = sheet.active_elements
    ends = np.concatenate([active[:, :2], active[:, 1:]])
    size = len(sheet.rest_m)
    links = coo_array((np.ones(len(ends), np.int8), ends.T), shape=(size, size))
    labels = connected_components(links, directed=False)[1][active[:, 0]]
    return np.unique(labels, return_inverse=True)[1]


def free_pieces(sheet: Sheet) -> list[NDArray[np.int64]]:
    """The elements of each piece in which nothing is pinned."""
    pieces = piece_of_elements(sheet)
    if pieces.max() == 0:
        return []
    held = np.unique(pieces[sheet.pinned[sheet.active_elements].any(axis=1)])
    return [np.flatnonzero(pieces == each) for each in np.setdiff1d(pieces, held)]


def area_m2(sheet: Sheet, elements: NDArray) -> float:
    """Return the area of a piece, in material coordinates."""
    a, b, c = sheet.rest_m[sheet.elements[elements]].transpose(1, 0, 2)
    return float(np.abs(_cross(b - a, c - a)).sum() / 2)


def area_in_circle_m2(sheet: Sheet, elements: NDArray, centre_m: NDArray, radius_m: float) -> float:
    """Return how much of a piece lies in a circle, exactly.

    The signed areas that the circle shares with the triangles from its centre to each side of an
    element add up to what it shares with the element; sides between two elements cancel out.
    """
    corners = sheet.rest_m[sheet.elements[elements]] - centre_m
    following = np.roll(corners, -1, axis=1)
    shared = _sector_area(corners.reshape(-1, 2), following.reshape(-1, 2), radius_m)
    return float(abs(shared.sum()))


def _sector_area(start: NDArray, end: NDArray, radius: float) -> NDArray[np.float64]:
    """(n,) signed area that a circle around 0 shares with the triangles (0, start, end)."""
    way = end - start
    a = np.maximum((way**2).sum(1), 1e-30)
    b = (start * way).sum(1)
    root = np.sqrt(np.maximum(b**2 - a * ((start**2).sum(1) - radius**2), 0.0))
    # The stretch of the side that lies inside the circle; empty where both ends coincide.
    enters = np.clip((-b - root) / a, 0.0, 1.0)[:, None]
    leaves = np.clip((-b + root) / a, 0.0, 1.0)[:, None]
    first, second = start + enters * way, start + leaves * way
    inner = _cross(first, second) / 2
    arcs = _angle(start, first) + _angle(second, end)
    return inner + radius**2 / 2 * arcs


def _angle(one: NDArray, other: NDArray) -> NDArray[np.float64]:
    return np.arctan2(_cross(one, other), (one * other).sum(1))


def _cross(first: NDArray, second: NDArray) -> NDArray[np.float64]:
    return first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
