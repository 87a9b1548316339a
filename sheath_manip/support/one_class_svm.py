"""The one-class support vector machine: how far inside the training states a vector lies.

Schölkopf et al. 2001, 'Estimating the support of a high-dimensional distribution'. The draft paper
calls nu the mass inside the support; it is the other way round: nu bounds the share of training
points left outside.
"""

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from sheath_manip.support.boundary import svm_boundary
from sheath_manip.support.dual_support import MAX_POINTS, DualSupport
from sheath_manip.support.vectors import checked_rows


class OneClassSupport(DualSupport):
    """The plain one-class SVM: every training state counts alike."""

    uses_agreement: ClassVar[bool] = False

    def __init__(
        self,
        nu: float = 0.05,
        bandwidth_factor: float = 1.0,
        max_points: int = MAX_POINTS,
        seed: int = 0,
        bandwidth_unit: str = "median",
    ) -> None:
        """Store the hyperparameters.

        Args:
            nu: in (0, 1]; at most this share of the training points ends up outside.
            bandwidth_factor: positive; smaller draws the support tighter around the points.
            max_points: of more points a uniform draw of this size is fitted to, since the cost
                grows with its square; the offset is then reset to the nu-quantile of the scores of
                ALL points, so that nu keeps its meaning.
            seed: of that draw, and of the one for the median distance.
            bandwidth_unit: `median`, the median squared distance between training points, or
                `dimensions`, the number of features.
        """
        super().__init__(nu, bandwidth_factor, max_points, seed, bandwidth_unit)

    def bounds(self, agrees: NDArray[np.bool_]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(n,) 1/(ν n) and (n,) 1."""
        count = len(agrees)
        return np.full(count, 1 / (self.nu * count)), np.ones(count)

    def boundary(self, rho: float, count: int) -> float:
        """ρ less a margin for rounding."""
        del count
        return svm_boundary(rho, self.nu)

    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) Σα_i k(x_i, x)/Σα - ρ/Σα: positive inside, NaN for rows that are not finite."""
        return self.kernel_sum_(checked_rows(X, len(self.kernel_sum_.center))) - self.rho_
