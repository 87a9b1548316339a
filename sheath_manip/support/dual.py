"""The dual of the one-class SVM: weights of the points and the score on the boundary.

    min ½ αᵀQα, Q_ij = y_i y_j k(x_i, x_j), Σα_i = 1, 0 <= α_i <= most_i

Plain: y_i = 1 and most_i = 1/(ν n), Schölkopf et al. 2001, 'Estimating the support of a
high-dimensional distribution'.
"""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.support.block_solver import BlockSolver
from sheath_manip.support.dense_solver import solve_dense
from sheath_manip.support.free_solver import solve_free
from sheath_manip.support.vectors import squared_distances

# Up to here libsvm holds the whole kernel, 200 MB; beyond, blocks of it are faster and as exact.
DIRECT_POINTS = 5000
# Where each point has a say blocks have to meet every point several times (13 s for 6600 states of
# 665 bits at c = 0.01·665); one linear system is quicker as long as it fits into memory, 800 MB.
FREE_POINTS = 20_000
NEARLY_ALL = 0.75
"""share of support vectors among so many points:"""
SAMPLE = 1000
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
    if len(points) <= DIRECT_POINTS:
        return _solve_at_once(points, c, most, signs)
    if len(points) <= FREE_POINTS and _nearly_all_count(points, c, most, signs):
        solved = solve_free(points, c, most, signs)
        if solved is not None:
            return solved
    return BlockSolver.of(points, c, most, signs).solve(earlier)


def _solve_at_once(
    points: NDArray[np.float64],
    c: float,
    most: NDArray[np.float64],
    signs: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float]:
    gram = squared_distances(points)
    gram /= -c
    np.exp(gram, out=gram)
    gram *= signs
    gram *= signs[:, None]
    return solve_dense(gram, most, 1.0, 1e-6)


def _nearly_all_count(
    points: NDArray[np.float64],
    c: float,
    most: NDArray[np.float64],
    signs: NDArray[np.float64],
) -> bool:
    """Whether c is so small that nearly every point is a support vector, judged by some of them."""
    some = slice(None, None, len(points) // SAMPLE)
    bounds = most[some] / most[some].sum() * most.sum()
    weights, _ = _solve_at_once(points[some], c, bounds, signs[some])
    return float((weights > 0).mean()) > NEARLY_ALL
