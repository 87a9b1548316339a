"""SHIV's one-class SVM: outside is what is unlike the training states OR like the policy's errors.

Laskey et al. 2016, 'SHIV: Reducing supervisor burden in DAgger using support vectors' (ICRA):
each training state carries y_i = +1 where the policy agrees with the expert and -1 where not;

    min ½ αᵀKα with K_ij = y_i y_j k(x_i, x_j), Σα_i = 1, 0 <= α_i <= 1/(ν m) where y_i = +1
    and <= 1/(ν_error m) where y_i = -1; inside where Σ y_i α_i k(x_i, x) > ρ.

Their code leaves y out of ρ, which can then be negative, so that states FAR AWAY pass as safe. Here
no state passes that the sum does not speak for.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from sheath_manip.support.boundary import check_share, svm_boundary
from sheath_manip.support.dual_support import MAX_POINTS, DualSupport
from sheath_manip.support.vectors import checked_rows

# A smaller offset is not told from 0: sums are float32, and libsvm solves to 1e-6. But without
# errors it is at least 1/n, the least square sum of duals that sum to 1, and there it counts.
LEAST_RHO = 1e-4


class LossAwareSupport(DualSupport):
    """One-class SVM that pushes the policy's errors outside.

    Where the policy agrees everywhere it is the plain one. Where errors and agreement are so mixed
    that nothing separates them (ρ <= 0), everything is outside.
    """

    uses_agreement: ClassVar[bool] = True

    def __init__(
        self,
        nu: float = 0.05,
        nu_error: float = 0.9,
        bandwidth_factor: float = 1.0,
        max_points: int = MAX_POINTS,
        seed: int = 0,
        bandwidth_unit: str = "median",
    ) -> None:
        """Store the hyperparameters.

        Args:
            nu: in (0, 1]; at most this share of the training points are states that the policy
                gets right and that end up outside.
            nu_error: in (0, 1]; at most this share of them are errors left inside. Theirs is .9:
                a lower one lets few errors outweigh many states around them.
            bandwidth_factor: positive; c in `bandwidth_unit`.
            max_points: of more points a uniform draw of this size is fitted to; the offset is then
                reset to the nu-quantile of the scores of all points that the policy gets right.
            seed: of that draw, and of the one for the median distance.
            bandwidth_unit: `median`, the median squared distance between training points, or
                `dimensions`, the number of features.
        """
        super().__init__(nu, bandwidth_factor, max_points, seed, bandwidth_unit)
        self.nu_error = nu_error

    def bounds(self, agrees: NDArray[np.bool_]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(n,) 1/(ν n) and 1 where the policy is right, 1/(ν_error n) and -1 where it errs."""
        check_share("nu_error", self.nu_error)
        most = 1 / (np.where(agrees, self.nu, self.nu_error) * len(agrees))
        return most, np.where(agrees, 1.0, -1.0)

    def boundary(self, rho: float, count: int) -> float:
        """ρ less a margin for rounding, or infinite."""
        return svm_boundary(rho, self.nu) if rho > min(LEAST_RHO, 0.5 / count) else np.inf

    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) Σ y_i α_i k(x_i, x) - ρ: positive inside, NaN for rows that are not finite.

        -inf, so outside under any threshold, where the sum is not positive: those states are more
        like errors than like what the policy gets right, or far from all. Else the former would
        score below the latter, and a threshold calibrated among errors would let in what is far.
        """
        sums = self.kernel_sum_(checked_rows(X, len(self.kernel_sum_.center)))
        return np.where(sums <= 0, -np.inf, sums - self.rho_)
