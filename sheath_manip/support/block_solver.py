"""The one-class SVM's dual for some hundred thousand points, as exact as float32 kernels are.

libsvm solves a block of it at a time, the points that violate optimality most, and one matrix
product tells all others of the step. Osuna, Freund & Girosi 1997, 'An improved training algorithm
for support vector machines'; the choice of the block is that of Joachims 1998, 'Making large-scale
SVM learning practical'.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.support.dense_solver import solve_dense
from sheath_manip.support.gaussian import LARGEST_SQUARE, columns_of, row_factor
from sheath_manip.support.vectors import squared_distances

# Points that enter a block from either end; those of the last one that are free stay in it.
BLOCK = 256
# Largest violation of optimality at the end, in units of the largest score.
TOLERANCE = 5e-7
# The start is the optimum of every COARSE-th point, as long as these are many, to this tolerance.
COARSE = 8
COARSE_POINTS = 1000
COARSE_TOLERANCE = 1e-3
# In float64 a dual this near a bound, in units of the bound, sits there.
ROUNDING = 1e-9


@dataclass(frozen=True)
class BlockSolver:
    """min ½ αᵀQα, Q_ij = y_i y_j exp(-|x_i - x_j|²/c), Σα_i = 1, 0 <= α_i <= most_i."""

    rows: NDArray[np.float32]
    """(n, d + 2) left factor of the points"""
    c: float
    most: NDArray[np.float64]
    """(n,) whose sum is above 1"""
    signs: NDArray[np.float64]
    """(n,) y, each 1 or -1"""

    @classmethod
    def of(cls, points: NDArray, c: float, most: NDArray, signs: NDArray) -> "BlockSolver":
        """Make blocks for (n, d) points with their mean near 0."""
        return cls(row_factor(points, 0.0), c, most, signs)

    def solve(
        self, earlier: NDArray[np.float64] | None = None, tolerance: float = TOLERANCE
    ) -> tuple[NDArray[np.float64], float]:
        """(n,) duals and ρ; `earlier` are (m <= n,) duals of the first m points to start from."""
        weights = self._coarse_start() if earlier is None else self._continued_start(earlier)
        scores = self.signs * self._sums(weights, self.rows)
        low, high = self._movable(weights, scores)
        block = np.empty(0, np.intp)
        # With a small bandwidth every point is a support vector, and each must be met a few times.
        for _ in range(100 + 8 * len(weights) // BLOCK):
            violation = high.max() - low.min()
            if violation <= tolerance * np.abs(scores).max():
                break
            block = _next_block(low, high, block)
            gram = np.exp(squared_distances(self.rows[block, :-2].astype(np.float64)) / -self.c)
            gram *= self.signs[block] * self.signs[block][:, None]
            steps = np.zeros(len(weights))
            steps[block] = _block_steps(
                gram, scores[block], weights[block], self.most[block], 0.05 * violation
            )
            # In float32 what is very far would not even see itself.
            own = scores[block] + gram @ steps[block]
            scores += self.signs * self._sums(steps, self.rows)
            scores[block] = own
            weights += steps
            weights[weights < self.most * ROUNDING] = 0
            low, high = self._movable(weights, scores)
        # What scores less than this has its dual at the bound, which no more than a share nu has.
        rho = min(low.min(), (low.min() + high.max()) / 2)
        return weights / weights.sum(), float(rho)

    def _movable(
        self, weights: NDArray[np.float64], scores: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(n,) scores, infinite where the dual cannot grow, and -infinite where not shrink."""
        low = np.where(weights < self.most * (1 - ROUNDING), scores, np.inf)
        return low, np.where(weights > 0, scores, -np.inf)

    def _sums(self, weights: NDArray[np.float64], rows: NDArray[np.float32]) -> NDArray[np.float64]:
        """(r,) Σ_j y_j w_j k(x_j, ·) for (n,) w and an (r, d + 2) left factor."""
        held = np.flatnonzero(weights)
        columns = columns_of(self.rows[held, :-2], self.signs[held] * weights[held], self.c)
        return columns.sums(rows)

    def _coarse_start(self) -> NDArray[np.float64]:
        """(n,) duals: the bounds of the points that score lowest under every COARSE-th one."""
        if len(self.rows) < COARSE * COARSE_POINTS:
            # What lies far from the mean is likely outside.
            return self._filled(
                self.signs * np.exp(self.rows[:, -2] / -self.c), np.zeros(len(self.rows))
            )
        some = slice(None, None, COARSE)
        most = self.most[some] / self.most[some].sum() * self.most.sum()
        coarse = BlockSolver(self.rows[some], self.c, most, self.signs[some])
        weights, _ = coarse.solve(tolerance=COARSE_TOLERANCE)
        scores = self.signs * coarse._sums(weights, self.rows)
        return self._filled(scores, np.zeros(len(self.rows)))

    def _continued_start(self, earlier: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n,) duals: the earlier ones' share, and the bounds of the lowest new points."""
        old = len(earlier)
        weights = np.zeros(len(self.rows))
        weights[:old] = np.minimum(earlier * (old / len(self.rows)), self.most[:old])
        weights[self._far()] = 0
        scores = np.full(len(self.rows), np.inf)
        scores[old:] = self.signs[old:] * self._sums(weights, self.rows[old:])
        return self._filled(scores, weights)

    def _filled(
        self, scores: NDArray[np.float64], weights: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """(n,) duals that sum to 1: `weights`, and up to their bounds from the lowest score on."""
        # A far point's own score is right only where it enters with its block, so it comes last.
        order = np.lexsort((scores, self._far()))
        spare = (self.most - weights)[order]
        filled = weights.copy()
        filled[order] += np.clip(1 - weights.sum() - (np.cumsum(spare) - spare), 0, spare)
        return filled

    def _far(self) -> NDArray[np.bool_]:
        """(n,) points too far from the mean for float32."""
        return self.rows[:, -2] > LARGEST_SQUARE * self.c


def _next_block(
    low: NDArray[np.float64], high: NDArray[np.float64], last: NDArray[np.intp]
) -> NDArray[np.intp]:
    """Indices of the worst points that can grow, that can shrink, and of the last that can both."""
    lowest, highest = np.argpartition(low, BLOCK)[:BLOCK], np.argpartition(-high, BLOCK)[:BLOCK]
    free = last[np.isfinite(low[last]) & np.isfinite(high[last])]
    movable = [lowest[np.isfinite(low[lowest])], highest[np.isfinite(high[highest])]]
    return np.union1d(np.concatenate(movable), free[: 2 * BLOCK])


def _block_steps(
    gram: NDArray[np.float64],
    scores: NDArray[np.float64],
    weights: NDArray[np.float64],
    most: NDArray[np.float64],
    tolerance: float,
) -> NDArray[np.float64]:
    """(b,) steps of a block's duals to their optimum with all others fixed; they sum to 0.

    Of the others only what they add to the scores counts, p with the term pᵀα. As the block's
    duals sum to s, that is ½ αᵀ(p1ᵀ + 1pᵀ)α / s: a matrix that libsvm takes like any other.
    """
    total = weights.sum()
    others = scores - gram @ weights
    others -= others @ weights / total
    # libsvm begins with the first at their bounds, so these had better be there already.
    order = np.argsort(-weights / most, kind="stable")
    matrix = (gram + (others + others[:, None]) / total)[np.ix_(order, order)]
    solved = np.empty(len(weights))
    solved[order], _ = solve_dense(matrix, most[order], total, tolerance / most.max())
    return np.clip(solved, 0, most) - weights
