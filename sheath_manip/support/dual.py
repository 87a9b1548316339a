"""The dual of the one-class SVM: weights of the points and the score on the boundary.

    min ½ αᵀQα, Q_ij = y_i y_j k(x_i, x_j), Σα_i = 1, 0 <= α_i <= most_i

Plain: y_i = 1 and most_i = 1/(ν n), Schölkopf et al. 2001, 'Estimating the support of a
high-dimensional distribution'.
"""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.support.blocks import BlockSolver
from sheath_manip.support.vectors import squared_distances
from sheath_manip.support.whole import solve_whole

# Up to here libsvm holds the whole kernel, 200 MB; beyond, blocks of it are faster and as exact.
DIRECT_POINTS = 5000
# Where every dual sits at its bound libsvm finds no offset: at nu = 1, and so above this.
MOST_NU = 0.999


def solve_dual(
    points: NDArray[np.float64],
    c: float,
    most: NDArray[np.float64],
    signs: NDArray[np.float64],
    earlier: NDArray[np.float64] | None = None,
) -> tuple[NDArray[np.float64], float]:
    """(n,) duals, which sum to 1, and ρ, for k(x, y) = exp(-|x - y|²/c).

    Args:
        points: (n, d) with their mean near 0.
        c: the bandwidth.
        most: (n,) bounds on the duals, whose sum is at least 1.
        signs: (n,) y, each 1 or -1.
        earlier: (m <= n,) duals of an earlier solution for the first m points. Beyond
            `DIRECT_POINTS` it saves time, and moves the result by no more than the tolerance.
    """
    most = most * max(1.0, 1 / (MOST_NU * most.sum()))
    if len(points) > DIRECT_POINTS:
        return BlockSolver.of(points, c, most, signs).solve(earlier)
    gram = np.exp(squared_distances(points) / -c) * signs * signs[:, None]
    return solve_whole(gram, most, 1.0, 1e-6)
