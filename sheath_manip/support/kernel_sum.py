"""A weighted sum of Gaussian kernels: what every one-class SVM scores with."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Arrays
from sheath_manip.support.gaussian import columns_of, row_factor, state_factor


class KernelSum:
    """x ↦ Σ w_i exp(-|x - center - v_i|²/c), in float32 once the center is taken off."""

    def __init__(self, center: NDArray, vectors: NDArray, weights: NDArray, c: float) -> None:
        """Take (d,) center, (m, d) vectors less it, (m,) weights and the bandwidth c > 0."""
        if vectors.shape != (len(weights), len(center)):
            raise ParameterError(
                f"support vectors have shape {vectors.shape}; wanted {(len(weights), len(center))}"
            )
        self.c = c
        # In float32 little would be left of data far from 0 for its spread.
        self.center = np.asarray(center, dtype=np.float64)
        self.vectors = np.ascontiguousarray(vectors, dtype=np.float32)
        self.weights = np.asarray(weights, dtype=np.float32)
        self._columns = columns_of(self.vectors, self.weights, c)

    def __call__(self, X: NDArray) -> NDArray[np.float64]:
        """Return (n,) sums for (n, d) rows; NaN for rows that are not finite."""
        if len(X) == 1 and (row := state_factor(X[0], self.center)) is not None:
            return np.array([self._columns.sum_of(row)])
        rows = row_factor(X, self.center)
        held = np.isfinite(rows[:, -2])
        if held.all():
            return self._columns.sums(rows)
        # What float32 cannot hold is far from every vector, or not finite.
        sums = np.where(np.isfinite(X).all(axis=1), 0.0, np.nan)
        sums[held] = self._columns.sums(rows[held])
        return sums

    def arrays(self) -> Arrays:
        """Center (d,), vectors less it (m, d), weights (m,) and c."""
        return {
            "center": self.center,
            "vectors": self.vectors,
            "weights": self.weights,
            "c": np.array(self.c),
        }

    @classmethod
    def of(cls, arrays: Arrays) -> "KernelSum":
        """Make a sum from `arrays()`; ParameterError where their shapes do not belong together."""
        return cls(arrays["center"], arrays["vectors"], arrays["weights"], float(arrays["c"]))
