"""The one-class support vector machine: how far inside the training states a vector lies.

Schölkopf et al. 2001, 'Estimating the support of a high-dimensional distribution'. The draft paper
calls nu the mass inside the support; it is the other way round: nu bounds the share of training
points left outside.
"""

from typing import Self

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import OneClassSVM

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Arrays

# Points between which the median distance is taken: half a million pairs.
MEDIAN_POINTS = 1000
# Rows scored at once: their kernel with 4000 support vectors takes 16 MB.
SCORE_BATCH = 1024
# Beyond this a vector is as far as any, and its square still fits float32.
LARGEST = 1e15


class OneClassSupport:
    """One-class SVM with k(x, y) = exp(-|x - y|²/c), its score divided by the sum of the duals.

    The bandwidth c is in the features' units squared, so it is scaled with the data:
    `bandwidth_factor` times the median squared distance between training points, `c_` once fitted.
    """

    def __init__(
        self,
        nu: float = 0.05,
        bandwidth_factor: float = 1.0,
        max_points: int = 4000,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters.

        Args:
            nu: in (0, 1]; at most this share of the training points ends up outside.
            bandwidth_factor: positive; smaller draws the support tighter around the points.
            max_points: of more points a uniform draw of this size is fitted to, since the cost
                grows with its square; the offset is then reset to the nu-quantile of the scores of
                ALL points, so that nu keeps its meaning.
            seed: of that draw, and of the one for the median distance.
        """
        self.nu = nu
        self.bandwidth_factor = bandwidth_factor
        self.max_points = max_points
        self.seed = seed

    def fit(self, X: NDArray) -> Self:
        """Fit to (n, d) finite vectors, n >= 2; ParameterError for other data or parameters."""
        self._check_parameters()
        X = _checked(X)
        rng = np.random.default_rng(self.seed)
        chosen = X
        if len(X) > self.max_points:
            chosen = X[rng.choice(len(X), self.max_points, replace=False)]
        # Distances stay, and rounding errors shrink, with the origin among the data.
        center = chosen.mean(axis=0)
        points = chosen - center
        self.c_ = self.bandwidth_factor * _median_squared_distance(points, rng)

        # One matrix product instead of libsvm's own kernel, which is far slower at 1280 dimensions.
        gram = np.exp(_squared_distances(points) / -self.c_)
        machine = OneClassSVM(kernel="precomputed", nu=self.nu, tol=1e-6).fit(gram)
        duals = np.asarray(machine.dual_coef_)[0]
        self._take(points[machine.support_], duals / duals.sum(), center)
        rho = float(np.ravel(machine.offset_)[0] / duals.sum())
        if len(X) > self.max_points:
            rho = float(np.quantile(self._similarities(X), self.nu, method="lower"))
        # Support vectors on the boundary sit at 0 ± rounding, and with a small c most points are
        # such: without a margin 30-60 % of the training set would be rejected. A hundredth of rho
        # bounds it, so that it never lets in what is unlike every point and scores -rho.
        self.rho_ = rho - min(max(1e-4 * self.nu, 1e-6), 1e-2 * rho)
        return self

    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) Σα_i k(x_i, x)/Σα - ρ/Σα: positive inside, NaN for rows that are not finite."""
        X = np.asarray(X)
        if X.ndim != 2 or X.shape[1] != len(self._center):
            raise ParameterError(
                f"cannot score vectors of shape {X.shape}; wanted (n, {len(self._center)})"
            )
        return self._similarities(X) - self.rho_

    def arrays(self) -> Arrays:
        """Center (d,), support vectors less it (m, d), weights (m,) that sum to 1, rho and c."""
        return {
            "center": self._center,
            "vectors": self._vectors,
            "weights": self._weights,
            "rho": np.array(self.rho_),
            "c": np.array(self.c_),
        }

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError where their shapes do not belong together."""
        center, vectors, weights = arrays["center"], arrays["vectors"], arrays["weights"]
        if vectors.shape != (len(weights), len(center)):
            raise ParameterError(
                f"support vectors have shape {vectors.shape}; wanted {(len(weights), len(center))}"
            )
        self.c_ = float(arrays["c"])
        self._take(vectors, weights, center)
        self.rho_ = float(arrays["rho"])
        return self

    def _take(self, vectors: NDArray, weights: NDArray, center: NDArray) -> None:
        self._center = np.asarray(center, dtype=np.float32)
        self._vectors = np.ascontiguousarray(vectors, dtype=np.float32)
        self._weights = np.asarray(weights, dtype=np.float32)
        # exp(-|x - v|²/c) = exp(2x·v/c - |v|²/c - |x|²/c): only the first term needs both.
        self._offsets = np.einsum("md,md->m", self._vectors, self._vectors) / np.float32(self.c_)

    def _similarities(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) Σα_i k(x_i, x)/Σα in float32; NaN for rows that are not finite."""
        similarities = np.empty(len(X))
        for start in range(0, len(X), SCORE_BATCH):
            rows = X[start : start + SCORE_BATCH]
            near = np.clip(rows, -LARGEST, LARGEST).astype(np.float32) - self._center
            squares = np.einsum("nd,nd->n", near, near) / np.float32(self.c_)
            near *= np.float32(2 / self.c_)
            kernel = near @ self._vectors.T
            kernel -= self._offsets
            kernel -= squares[:, None]
            np.minimum(kernel, 0, out=kernel)
            np.exp(kernel, out=kernel)
            part = (kernel @ self._weights).astype(np.float64)
            part[~np.isfinite(rows).all(axis=1)] = np.nan
            similarities[start : start + SCORE_BATCH] = part
        return similarities

    def _check_parameters(self) -> None:
        if not 0 < self.nu <= 1:
            raise ParameterError(
                f"nu is {self.nu}; wanted a share above 0 and at most 1, like 0.05"
            )
        if not 0 < self.bandwidth_factor < np.inf:
            raise ParameterError(
                f"bandwidth_factor is {self.bandwidth_factor}; wanted a positive number, like 1.0"
            )
        if self.max_points < 2:
            raise ParameterError(f"max_points is {self.max_points}; wanted at least 2, like 4000")


def _checked(X: NDArray) -> NDArray[np.float64]:
    X = np.asarray(X, dtype=np.float64)
    if X.ndim != 2 or X.shape[1] == 0:
        raise ParameterError(f"cannot fit a support to shape {X.shape}; wanted (n, d) vectors")
    if len(X) < 2:
        raise ParameterError(f"cannot fit a support to {len(X)} vectors; wanted at least 2")
    broken = int((~np.isfinite(X).all(axis=1)).sum())
    if broken:
        raise ParameterError(f"{broken} of {len(X)} training vectors are not finite; wanted none")
    return X


def _squared_distances(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, n) between (n, d) points, exactly 0 on the diagonal."""
    squares = np.einsum("nd,nd->n", points, points)
    distances = squares[:, None] + squares[None] - 2 * (points @ points.T)
    np.maximum(distances, 0, out=distances)
    np.fill_diagonal(distances, 0)
    return distances


def _median_squared_distance(points: NDArray[np.float64], rng: np.random.Generator) -> float:
    if len(points) > MEDIAN_POINTS:
        points = points[rng.choice(len(points), MEDIAN_POINTS, replace=False)]
    distances = _squared_distances(points)[np.triu_indices(len(points), 1)]
    apart = distances[distances > 0]
    if len(apart) == 0:
        raise ParameterError(
            "all training vectors are equal, so they have no scale; wanted at least two that differ"
        )
    return float(np.median(apart))
