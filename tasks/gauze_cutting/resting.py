"""Where a sheet comes to rest between its clips: linear elasticity, solved once."""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array

from sheath_manip.tasks.gauze_cutting.cutting.elasticity import stretch_stiffness
from sheath_manip.tasks.gauze_cutting.geometry import CLIP_OF_VERTEX, MEMBRANE, MESH


@cache
def clip_response() -> NDArray[np.float64]:
    """Return (n, 2, 4, 2) by how much of each clip's displacement each vertex is displaced.

    At rest the energy 1/2 sum K_ij s_i s_j of the elements (`cutting.elasticity`) is least, to
    first order in the displacements u, with s_i = 2 e_i . (u_b - u_a) along the edge e_i from a to
    b. It does not depend on Young's modulus. What is left to come to rest is of second order.
    """
    count = len(MESH.points_m)
    stiffness = _stiffness()
    moved = np.zeros((count, 2, 4, 2))
    held = np.flatnonzero(CLIP_OF_VERTEX >= 0)
    moved[held, :, CLIP_OF_VERTEX[held]] = np.eye(2)
    columns = moved.reshape(2 * count, 8)
    free = np.flatnonzero(np.repeat(CLIP_OF_VERTEX < 0, 2))
    fixed = np.setdiff1d(np.arange(2 * count), free)
    force = -stiffness[free][:, fixed] @ columns[fixed]
    columns[free] = np.linalg.solve(stiffness[free][:, free], force)
    return columns.reshape(count, 2, 4, 2)


def _stiffness() -> NDArray[np.float64]:
    """(2n, 2n) of all vertices along x and y in turn."""
    corners = MESH.points_m[MESH.triangles]
    upper = stretch_stiffness(corners, MEMBRANE)
    pairs = np.empty((len(upper), 3, 3))
    rows, columns = np.triu_indices(3)
    pairs[:, rows, columns] = pairs[:, columns, rows] = upper
    # By element, edge (which faces the corner of its number), corner and axis: of s_i.
    edges = np.roll(corners, 1, axis=1) - np.roll(corners, -1, axis=1)
    slopes = np.zeros((len(upper), 3, 3, 2))
    for edge in range(3):
        slopes[:, edge, (edge - 1) % 3] = 2 * edges[:, edge]
        slopes[:, edge, (edge + 1) % 3] = -2 * edges[:, edge]
    slopes = slopes.reshape(len(upper), 3, 6)
    blocks = np.einsum("tij,tia,tjb->tab", pairs, slopes, slopes)
    places = (2 * MESH.triangles[..., None] + np.arange(2)).reshape(-1, 6)
    size = 2 * len(MESH.points_m)
    rows, columns = np.broadcast_arrays(places[:, :, None], places[:, None, :])
    summed = coo_array((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))
    return summed.toarray()
