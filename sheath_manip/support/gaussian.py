"""Sums of Gaussian kernels: one float32 matrix product and one exponential for many vectors.

exp(-|x - v|²/c) = exp(2x·v/c - |x|²/c - |v|²/c), and the squares ride along as two more dimensions
of the product: [x, |x|², 1] · [2v/c, -1/c, -|v|²/c].
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_blas_funcs

from sheath_manip.rollout.device import is_cpu, torch_device

# BLAS itself does not warn of an overflow, and turning numpy's warning off takes a microsecond.
(dot,) = get_blas_funcs(("dot",), dtype=np.float64)
# Columns at once, whose sum is float32's.
COLUMNS = 16384
# Entries of their kernel at once, 2 MB that stay in the cache from the product to the sum; but no
# fewer rows than these, since a product of few rows is slow.
TILE = 1 << 19
ROWS = 256
# Squares above this, in units of c, leave rounding errors that show, and that an exponential may
# blow up.
LARGEST_SQUARE = 1e4
# float32 holds squares up to here, with room to spare.
LARGEST_HELD = 1e30
# An array, since numpy converts a Python number anew in every call.
ZERO = np.zeros((), np.float32)


def row_factor(X: NDArray, origin: NDArray | float) -> NDArray[np.float32]:
    """(n, d + 2) left factor for (n, d) vectors less the origin, which float32 had better be near.

    Its last column but one is |x|², infinite or NaN for what float32 cannot hold.
    """
    factor = np.empty((len(X), X.shape[1] + 2), np.float32)
    near = factor[:, :-2]
    with np.errstate(over="ignore"):
        np.subtract(X, origin, out=near)
        np.vecdot(near, near, out=factor[:, -2])
    factor[:, -1] = 1
    return factor


def state_factor(x: NDArray, origin: NDArray) -> NDArray[np.float32] | None:
    """(d + 2,) the row of `row_factor` for one (d,) vector; None where float32 cannot hold it.

    A control loop asks for one state at a time, and there `row_factor` takes longer to get ready
    than the product itself.
    """
    near = x - origin
    square = dot(near, near)
    if not square < LARGEST_HELD:
        return None
    row = np.empty(len(near) + 2, np.float32)
    row[:-2] = near
    row[-2] = square
    row[-1] = 1
    return row


class Columns(Protocol):
    """Σ w_j exp(-|x - v_j|²/c) over fixed vectors v_j, for the left factors of any x."""

    def sum_of(self, row: NDArray[np.float32]) -> float:
        """The sum for one (d + 2,) row of a left factor."""
        ...

    def sums(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return the (n,) sums for an (n, d + 2) left factor."""
        ...


def columns_of(vectors: NDArray, weights: NDArray, c: float) -> Columns:
    """Return the sums over (m, d) vectors with (m,) weights, where this process computes."""
    if is_cpu():
        return GaussianColumns(vectors, weights, c)
    # Only now: the CPU does without torch.
    from sheath_manip.support.gaussian_on_device import DeviceColumns

    return DeviceColumns(vectors, weights, c, torch_device())


class GaussianColumns:
    """Σ w_j exp(-|x - v_j|²/c) over fixed vectors v_j, for the left factors of any x."""

    def __init__(self, vectors: NDArray, weights: NDArray, c: float) -> None:
        """Take (m, d) vectors and their (m,) weights."""
        squared = np.vecdot(vectors, vectors) / c
        self._exceed = bool((squared > LARGEST_SQUARE).any())
        self._parts: list[tuple[NDArray[np.float32], NDArray[np.float32]]] = []
        for start in range(0, len(vectors), COLUMNS):
            some = slice(start, start + COLUMNS)
            # Laid out so that one row times it runs fastest.
            factor = np.empty((vectors.shape[1] + 2, len(squared[some])), np.float32)
            factor[:-2] = vectors[some].T * (2 / c)
            factor[-2] = -1 / c
            factor[-1] = -squared[some]
            self._parts.append((factor, np.asarray(weights[some], np.float32)))

    def sum_of(self, row: NDArray[np.float32]) -> float:
        """The sum for one (d + 2,) row of a left factor."""
        total = 0.0
        for factor, weights in self._parts:
            total += float(self._tile(row, factor, weights))
        return total

    def sums(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return the (n,) sums for an (n, d + 2) left factor."""
        if len(self._parts) == 1 and len(rows) <= ROWS:
            return self._tile(rows, *self._parts[0]).astype(np.float64)
        sums = np.zeros(len(rows))
        for factor, weights in self._parts:
            height = max(ROWS, TILE // len(weights))
            for start in range(0, len(rows), height):
                some = slice(start, start + height)
                sums[some] += self._tile(rows[some], factor, weights)
        return sums

    def _tile(
        self,
        rows: NDArray[np.float32],
        factor: NDArray[np.float32],
        weights: NDArray[np.float32],
    ) -> NDArray[np.float32]:
        """(n,) for (n, d + 2) rows, or one sum for a (d + 2,) row."""
        # On one row `dot` costs less than `@`.
        kernel = rows.dot(factor)
        if self._exceed:
            np.minimum(kernel, ZERO, out=kernel)
        return np.exp(kernel, out=kernel).dot(weights)
