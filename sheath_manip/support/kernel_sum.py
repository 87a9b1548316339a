"""A weighted sum of Gaussian kernels: what every one-class SVM scores with."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Arrays
from sheath_manip.support.vectors import LARGEST

# Rows scored at once: their kernel with 4000 support vectors takes 16 MB.
SCORE_BATCH = 1024


class KernelSum:
    """x ↦ Σ w_i exp(-|x - center - v_i|²/c) in float32, one matrix product for all rows."""

    def __init__(self, center: NDArray, vectors: NDArray, weights: NDArray, c: float) -> None:
        """Take (d,) center, (m, d) vectors less it, (m,) weights and the bandwidth c > 0."""
        if vectors.shape != (len(weights), len(center)):
            raise ParameterError(
                f"support vectors have shape {vectors.shape}; wanted {(len(weights), len(center))}"
            )
        self.c = c
        self.center = np.asarray(center, dtype=np.float32)
        self.vectors = np.ascontiguousarray(vectors, dtype=np.float32)
        self.weights = np.asarray(weights, dtype=np.float32)
        # exp(-|x - v|²/c) = exp(2x·v/c - |v|²/c - |x|²/c): only the first term needs both.
        self._offsets = np.einsum("md,md->m", self.vectors, self.vectors) / np.float32(c)

    def __call__(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) for (n, d) rows; NaN for rows that are not finite."""
        sums = np.empty(len(X))
        for start in range(0, len(X), SCORE_BATCH):
            rows = X[start : start + SCORE_BATCH]
            near = np.clip(rows, -LARGEST, LARGEST).astype(np.float32) - self.center
            squares = np.einsum("nd,nd->n", near, near) / np.float32(self.c)
            near *= np.float32(2 / self.c)
            kernel = near @ self.vectors.T
            kernel -= self._offsets
            kernel -= squares[:, None]
            np.minimum(kernel, 0, out=kernel)
            np.exp(kernel, out=kernel)
            part = (kernel @ self.weights).astype(np.float64)
            part[~np.isfinite(rows).all(axis=1)] = np.nan
            sums[start : start + SCORE_BATCH] = part
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
        """From `arrays()`; ParameterError where their shapes do not belong together."""
        return cls(arrays["center"], arrays["vectors"], arrays["weights"], float(arrays["c"]))
