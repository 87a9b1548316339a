"""The one-class support vector machine: how far inside the training states a vector lies.

Schölkopf et al. 2001, 'Estimating the support of a high-dimensional distribution'. The draft paper
calls nu the mass inside the support; it is the other way round: nu bounds the share of training
points left outside.
"""

from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.svm import OneClassSVM

from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import (
    MOST_NU,
    check_least,
    check_positive,
    check_share,
    svm_boundary,
)
from sheath_manip.support.kernel_sum import KernelSum
from sheath_manip.support.vectors import (
    checked_rows,
    checked_training,
    median_squared_distance,
    squared_distances,
)


class OneClassSupport:
    """One-class SVM with k(x, y) = exp(-|x - y|²/c), its score divided by the sum of the duals.

    The bandwidth c is in the features' units squared, so it is scaled with the data:
    `bandwidth_factor` times the median squared distance between training points, `c_` once fitted.
    """

    uses_agreement: ClassVar[bool] = False

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

    def fit(self, X: NDArray, agrees: NDArray | None = None) -> Self:
        """Fit to (n, d) finite vectors, n >= 2; ParameterError for other data or parameters."""
        del agrees
        check_share("nu", self.nu)
        check_positive(bandwidth_factor=self.bandwidth_factor)
        check_least({"max_points": (self.max_points, 2)})
        X = checked_training(X)
        rng = np.random.default_rng(self.seed)
        chosen = X
        if len(X) > self.max_points:
            chosen = X[rng.choice(len(X), self.max_points, replace=False)]
        # Distances stay, and rounding errors shrink, with the origin among the data.
        center = chosen.mean(axis=0)
        points = chosen - center
        self.c_ = self.bandwidth_factor * median_squared_distance(points, rng)

        # One matrix product instead of libsvm's own kernel, which is far slower at 1280 dimensions.
        gram = np.exp(squared_distances(points) / -self.c_)
        nu = min(self.nu, MOST_NU)
        machine = OneClassSVM(kernel="precomputed", nu=nu, tol=1e-6).fit(gram)
        duals = np.asarray(machine.dual_coef_)[0]
        self.kernel_sum_ = KernelSum(center, points[machine.support_], duals / duals.sum(), self.c_)
        rho = float(np.ravel(machine.offset_)[0] / duals.sum())
        if len(X) > self.max_points:
            rho = float(np.quantile(self.kernel_sum_(X), self.nu, method="lower"))
        self.rho_ = svm_boundary(rho, self.nu)
        return self

    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) Σα_i k(x_i, x)/Σα - ρ/Σα: positive inside, NaN for rows that are not finite."""
        return self.kernel_sum_(checked_rows(X, len(self.kernel_sum_.center))) - self.rho_

    def arrays(self) -> Arrays:
        """Center (d,), support vectors less it (m, d), weights (m,) that sum to 1, rho and c."""
        return {**self.kernel_sum_.arrays(), "rho": np.array(self.rho_)}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError where their shapes do not belong together."""
        self.kernel_sum_ = KernelSum.of(arrays)
        self.c_ = self.kernel_sum_.c
        self.rho_ = float(arrays["rho"])
        return self
