"""SHIV's one-class SVM: outside is what is unlike the training states OR like the policy's errors.

Laskey et al. 2016, 'SHIV: Reducing supervisor burden in DAgger using support vectors' (ICRA):
each training state carries y_i = +1 where the policy agrees with the expert and -1 where not;

    min ½ αᵀKα with K_ij = y_i y_j k(x_i, x_j), Σα_i = 1, 0 <= α_i <= 1/(ν m) where y_i = +1
    and <= 1/(ν_error m) where y_i = -1; inside where Σ y_i α_i k(x_i, x) > ρ.

Their code leaves y out of ρ, which can then be negative, so that states FAR AWAY pass as safe. Here
no state passes that the sum does not speak for.
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
    checked_agreement,
    checked_rows,
    checked_training,
    median_squared_distance,
    squared_distances,
)

# A smaller offset is not told from 0: sums are float32, and libsvm solves to 1e-6. Without errors
# it is at least 1 / max_points, the least square sum of duals that sum to 1.
LEAST_RHO = 1e-4


class LossAwareSupport:
    """One-class SVM with k(x, y) = exp(-|x - y|²/c) that pushes the policy's errors outside.

    Where the policy agrees everywhere it is the plain one. Where errors and agreement are so mixed
    that nothing separates them (ρ <= 0), everything is outside.
    """

    uses_agreement: ClassVar[bool] = True

    def __init__(
        self,
        nu: float = 0.05,
        nu_error: float = 0.9,
        bandwidth_factor: float = 1.0,
        max_points: int = 4000,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters.

        Args:
            nu: in (0, 1]; at most this share of the training points are states that the policy
                gets right and that end up outside.
            nu_error: in (0, 1]; at most this share of them are errors left inside. Theirs is .9:
                a lower one lets few errors outweigh many states around them.
            bandwidth_factor: positive; c in units of the median squared distance.
            max_points: of more points a uniform draw of this size is fitted to; the offset is then
                reset to the nu-quantile of the scores of all points that the policy gets right.
            seed: of that draw, and of the one for the median distance.
        """
        self.nu = nu
        self.nu_error = nu_error
        self.bandwidth_factor = bandwidth_factor
        self.max_points = max_points
        self.seed = seed

    def fit(self, X: NDArray, agrees: NDArray | None = None) -> Self:
        """Fit to (n, d) finite vectors, n >= 2, and (n,) bool: the policy is right there."""
        check_share("nu", self.nu)
        check_share("nu_error", self.nu_error)
        check_positive(bandwidth_factor=self.bandwidth_factor)
        check_least({"max_points": (self.max_points, 2)})
        X = checked_training(X)
        agrees = checked_agreement(agrees, len(X))
        rng = np.random.default_rng(self.seed)
        chosen = np.arange(len(X))
        if len(X) > self.max_points:
            chosen = rng.choice(len(X), self.max_points, replace=False)
        center = X[chosen].mean(axis=0)
        points = X[chosen] - center
        self.c_ = self.bandwidth_factor * median_squared_distance(points, rng)

        gram = np.exp(squared_distances(points) / -self.c_)
        signs = np.where(agrees[chosen], 1.0, -1.0)
        support, duals, rho = self._solved(gram, signs)
        self.kernel_sum_ = KernelSum(center, points[support], signs[support] * duals, self.c_)
        if len(X) > self.max_points and agrees.any():
            rho = float(np.quantile(self.kernel_sum_(X[agrees]), self.nu, method="lower"))
        self.rho_ = svm_boundary(rho, self.nu) if rho > LEAST_RHO else np.inf
        return self

    def _solved(
        self, gram: NDArray[np.float64], signs: NDArray[np.float64]
    ) -> tuple[NDArray[np.int32], NDArray[np.float64], float]:
        """(s,) indices of the support vectors, their (s,) duals, which sum to 1, and ρ."""
        # libsvm bounds a dual by its sample's weight and makes them sum to nu · Σ weights, so both
        # are the dual above times m.
        weights = np.where(signs > 0, 1 / self.nu, 1 / self.nu_error)
        machine = OneClassSVM(
            kernel="precomputed", nu=min(MOST_NU, len(signs) / weights.sum()), tol=1e-6
        )
        machine.fit(gram * signs * signs[:, None], sample_weight=weights)
        duals = np.asarray(machine.dual_coef_)[0]
        total = duals.sum()
        return machine.support_, duals / total, float(np.ravel(machine.offset_)[0] / total)

    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) Σ y_i α_i k(x_i, x) - ρ: positive inside, NaN for rows that are not finite.

        -inf, so outside under any threshold, where the sum is not positive: those states are more
        like errors than like what the policy gets right, or far from all. Else the former would
        score below the latter, and a threshold calibrated among errors would let in what is far.
        """
        sums = self.kernel_sum_(checked_rows(X, len(self.kernel_sum_.center)))
        return np.where(sums <= 0, -np.inf, sums - self.rho_)

    def arrays(self) -> Arrays:
        """Center (d,), vectors less it (m, d), signed weights (m,), rho (inf: all out) and c."""
        return {**self.kernel_sum_.arrays(), "rho": np.array(self.rho_)}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError where their shapes do not belong together."""
        self.kernel_sum_ = KernelSum.of(arrays)
        self.c_ = self.kernel_sum_.c
        self.rho_ = float(arrays["rho"])
        return self
