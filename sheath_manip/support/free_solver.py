"""The dual where nearly every point is a support vector between its bounds.

What is left of it then is a linear system, Qα = ρ on the free points, which conjugate gradients
solve on a kernel held in float32. Which points sit at a bound is found in a few rounds:
Hintermüller, Ito & Kunisch 2002, 'The primal-dual active set strategy as a semismooth Newton
method'.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import ssymv  # pyright: ignore[reportAttributeAccessIssue]

from sheath_manip.support.gaussian import LARGEST_SQUARE, row_factor

ROUNDS = 20
STEPS = 300
"""of conjugate gradients in a round: a kernel that needs more is none for this"""
TOLERANCE = 1e-6
"""on the scores of free points, in units of the boundary's; float32 knows no more"""
COARSE_TOLERANCE = 1e-3
"""the same until it is settled which points are free"""
ROWS = 1024
"""of the kernel made at once"""

Product = Callable[[NDArray[np.float64]], NDArray[np.float64]]


def solve_free(
    points: NDArray[np.float64],
    c: float,
    most: NDArray[np.float64],
    signs: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float] | None:
    """(n,) duals, which sum to 1, and ρ, as `solve_dual`; None where that does not settle.

    Points that are equal count as one, since of them only the sum is determined. Half a kernel is
    held, 2 n² bytes.
    """
    alike, first, which = _equal(points, signs)
    together = np.asarray(np.bincount(which, most), np.float64)
    solved = _solve_apart(points[first], c, together, signs[first])
    if solved is None:
        return None
    weights, rho = solved
    # The first of those that are equal take what they can, so that the others need no kernel.
    before = np.cumsum(most[alike]) - most[alike]
    before -= before[np.searchsorted(which[alike], np.arange(len(first)))][which[alike]]
    shared = np.empty(len(points))
    shared[alike] = np.clip(weights[which[alike]] - before, 0, most[alike])
    return shared, rho


def _equal(
    points: NDArray[np.float64], signs: NDArray[np.float64]
) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.intp]]:
    """(n,) an order with equal points side by side, (m,) one of each, and (n,) which of these."""
    rows = np.column_stack([points, signs])
    bytes_of = rows.view(np.dtype((np.void, rows.strides[0])))[:, 0]
    _, first, which = np.unique(bytes_of, return_index=True, return_inverse=True)
    return np.argsort(which, kind="stable"), first, which


def _solve_apart(
    points: NDArray[np.float64],
    c: float,
    most: NDArray[np.float64],
    signs: NDArray[np.float64],
) -> tuple[NDArray[np.float64], float] | None:
    """Solve for points of which no two are equal."""
    kernel = _lower_kernel(points, c)
    if kernel is None:
        return None

    def product(vector: NDArray[np.float64]) -> NDArray[np.float64]:
        # BLAS counts columns first, and there the lower half is the upper one.
        return signs * ssymv(1.0, kernel.T, (signs * vector).astype(np.float32))

    zero = full = np.zeros(len(points), np.bool_)
    ones, pushed = np.zeros((2, len(points)))
    tolerance = COARSE_TOLERANCE
    for _ in range(ROUNDS):
        free = ~(zero | full)
        fixed = np.where(full, most, 0.0)
        ones = _solved(product, free.astype(np.float64), free, ones, tolerance)
        pushed = _solved(product, product(fixed), free, pushed, tolerance)
        if ones is None or pushed is None or not ones.sum() > 0:
            return None
        # Free points score ρ, and all duals sum to 1.
        rho = (1 - fixed.sum() + pushed.sum()) / ones.sum()
        weights = fixed + rho * ones - pushed
        scores = product(weights)
        lower = np.where(zero, scores > rho, weights < 0)
        upper = np.where(full, scores < rho, weights > most)
        if (lower == zero).all() and (upper == full).all():
            if tolerance == TOLERANCE:
                return weights / weights.sum(), float(rho / weights.sum())
            tolerance = TOLERANCE
        zero, full = lower, upper
    return None


def _solved(
    product: Product,
    wanted: NDArray[np.float64],
    free: NDArray[np.bool_],
    start: NDArray[np.float64],
    tolerance: float,
) -> NDArray[np.float64] | None:
    """(n,) x, 0 where not free, with Qx as wanted where free; None after too many steps."""
    wanted = free * wanted
    if not wanted.any():
        return wanted
    solution = free * start
    residual = wanted - free * product(solution)
    direction = residual.copy()
    square = residual @ residual
    enough = tolerance**2 * (wanted @ wanted)
    for _ in range(STEPS):
        if square <= enough:
            return solution
        onward = free * product(direction)
        bend = direction @ onward
        if not bend > 0:
            return None
        solution += square / bend * direction
        residual -= square / bend * onward
        last, square = square, residual @ residual
        direction = residual + square / last * direction
    return None


def _lower_kernel(points: NDArray[np.float64], c: float) -> NDArray[np.float32] | None:
    """(n, n) whose lower half is exp(-|x - y|²/c); None where float32 cannot tell points apart."""
    rows = row_factor(points, 0.0)
    if not (rows[:, -2] <= LARGEST_SQUARE * c).all():
        return None
    columns = np.empty((rows.shape[1], len(rows)), np.float32)
    columns[:-2] = rows[:, :-2].T * np.float32(2 / c)
    columns[-2] = -1 / c
    columns[-1] = rows[:, -2] * np.float32(-1 / c)
    # What is never written takes no memory.
    kernel = np.empty((len(rows), len(rows)), np.float32)
    for first in range(0, len(rows), ROWS):
        last = min(first + ROWS, len(rows))
        tile = kernel[first:last, :last]
        np.matmul(rows[first:last], columns[:, :last], out=tile)
        np.exp(np.minimum(tile, 0, out=tile), out=tile)
    np.fill_diagonal(kernel, 1)
    return kernel
