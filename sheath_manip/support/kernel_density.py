"""Kernel density: the log of a sum of Gaussians, one on each training state.

Parzen 1962, 'On estimation of a probability density function and mode'. Every training state weighs
alike, where the one-class SVM puts its weights on few, along the boundary.
"""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import check_least, check_positive
from sheath_manip.support.quantile_support import SCORE_BATCH, QuantileSupport
from sheath_manip.support.vectors import bandwidth


class KernelDensitySupport(QuantileSupport):
    """Log density under kernels exp(-|x - y|²/c), with c as in `OneClassSupport`."""

    def __init__(
        self,
        nu: float = 0.05,
        bandwidth_factor: float = 1.0,
        max_points: int = 4000,
        seed: int = 0,
        bandwidth_unit: str = "median",
    ) -> None:
        """Store the hyperparameters.

        Args:
            nu: in (0, 1]; the share of the training points outside.
            bandwidth_factor: positive; c in `bandwidth_unit`.
            max_points: of more points the kernels sit on a uniform draw of this size; the boundary
                is the nu-quantile over all.
            seed: of that draw, and of the one for the median distance.
            bandwidth_unit: `median`, the median squared distance between training points, or
                `dimensions`, the number of features.
        """
        self.nu = nu
        self.bandwidth_factor = bandwidth_factor
        self.max_points = max_points
        self.seed = seed
        self.bandwidth_unit = bandwidth_unit

    def learn(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) log densities, each vector's own kernel counted."""
        check_positive(bandwidth_factor=self.bandwidth_factor)
        check_least({"max_points": (self.max_points, 2)})
        rng = np.random.default_rng(self.seed)
        chosen = Z
        if len(Z) > self.max_points:
            chosen = Z[rng.choice(len(Z), self.max_points, replace=False)]
        points = chosen.astype(np.float64)
        c = bandwidth(points, self.bandwidth_factor, self.bandwidth_unit, rng)
        self._place(chosen, c)
        batches = range(0, len(Z), SCORE_BATCH)
        return np.concatenate([self.rate(Z[start : start + SCORE_BATCH]) for start in batches])

    def rate(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) log densities, up to a constant."""
        # -|z - v|²/c without |z|²/c, which is the same for all v and would cost digits.
        exponents = Z @ self._columns
        exponents -= self._offsets
        highest = exponents.max(axis=1)
        exponents -= highest[:, None]
        sums = np.exp(exponents, out=exponents).sum(axis=1, dtype=np.float64)
        near = Z.astype(np.float64)
        return np.log(sums) + highest - np.vecdot(near, near) / self.c_

    def learned(self) -> Arrays:
        """The kernels' (m, d) centres and c, in scaled units."""
        return {"vectors": self.vectors_, "c": np.array(self.c_)}

    def take(self, arrays: Arrays) -> None:
        """Take over `learned()`."""
        self._place(np.asarray(arrays["vectors"], dtype=np.float32), float(arrays["c"]))

    def _place(self, vectors: NDArray[np.float32], c: float) -> None:
        self.vectors_, self.c_ = vectors, c
        self._offsets = np.vecdot(vectors, vectors) / np.float32(c)
        # Laid out so that one row times it runs fastest.
        self._columns = np.ascontiguousarray(vectors.T * np.float32(2 / c))
