"""What the one-class SVMs share that differ in their points' signs and bounds."""

from abc import ABC, abstractmethod
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import check_least, check_positive, check_share
from sheath_manip.support.dual import solve_dual
from sheath_manip.support.kernel_sum import KernelSum
from sheath_manip.support.vectors import (
    LARGEST,
    bandwidth,
    checked_agreement,
    checked_training,
)

# Of these a fit takes 20 CPU seconds at 64 dimensions and nu = 0.1, and a score, which looks at a
# share nu of them, 0.2 ms.
MAX_POINTS = 200_000


class DualSupport(ABC):
    """One-class SVM with k(x, y) = exp(-|x - y|²/c), its score divided by the sum of the duals.

    The bandwidth c, `c_` once fitted, is in the features' units squared: `bandwidth_factor` times
    the median squared distance between training points, or times the number of dimensions.
    """

    uses_agreement: ClassVar[bool]

    # The duals of the last fit, unless that was to a draw; not part of `arrays()`.
    _duals: NDArray[np.float64] | None = None

    def __init__(
        self, nu: float, bandwidth_factor: float, max_points: int, seed: int, bandwidth_unit: str
    ) -> None:
        """Store the hyperparameters that all have."""
        self.nu = nu
        self.bandwidth_factor = bandwidth_factor
        self.max_points = max_points
        self.seed = seed
        self.bandwidth_unit = bandwidth_unit

    @abstractmethod
    def bounds(self, agrees: NDArray[np.bool_]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(n,) bounds on the duals, whose sum is at least 1, and (n,) signs of the points."""

    @abstractmethod
    def boundary(self, rho: float, count: int) -> float:
        """The score at which the support of `count` points ends, for a dual's or quantile's ρ."""

    def fit(self, X: NDArray, agrees: NDArray | None = None) -> Self:
        """Fit to (n, d) finite vectors, n >= 2; ParameterError for other data or parameters."""
        return self._fit(X, agrees, None)

    def refit(self, X: NDArray, agrees: NDArray | None = None) -> Self:
        """`fit`, sooner and up to rounding, where X begins with the states of the last fit.

        These come in the same order, but may be embedded anew; new ones follow. Up to
        `DIRECT_POINTS`, beyond `max_points` and after `load` nothing is saved. ParameterError where
        X is shorter than what was fitted last.
        """
        if self._duals is not None and len(X) < len(self._duals):
            raise ParameterError(
                f"cannot refit to {len(X)} vectors after {len(self._duals)}; wanted those, in "
                "their order, and new ones after them: for other data use fit"
            )
        return self._fit(X, agrees, self._duals)

    def _fit(self, X: NDArray, agrees: NDArray | None, duals: NDArray[np.float64] | None) -> Self:
        check_share("nu", self.nu)
        check_positive(bandwidth_factor=self.bandwidth_factor)
        check_least({"max_points": (self.max_points, 2)})
        X = checked_training(X)
        agrees = checked_agreement(agrees if self.uses_agreement else None, len(X))
        rng = np.random.default_rng(self.seed)
        drawn = len(X) > self.max_points
        chosen = rng.choice(len(X), self.max_points, replace=False) if drawn else slice(None)
        # Distances stay, and rounding errors shrink, with the origin among the data.
        center = X[chosen].mean(axis=0)
        points = X[chosen] - center
        self.c_ = bandwidth(points, self.bandwidth_factor, self.bandwidth_unit, rng)

        most, signs = self.bounds(agrees[chosen])
        weights, rho = solve_dual(points, self.c_, most, signs, None if drawn else duals)
        held = np.flatnonzero(weights)
        self.kernel_sum_ = KernelSum(center, points[held], (signs * weights)[held], self.c_)
        if drawn and agrees.any():
            rho = float(np.quantile(self.kernel_sum_(X[agrees]), self.nu, method="lower"))
        self.rho_ = self.boundary(rho, len(points))
        self._duals = None if drawn else weights
        return self

    @abstractmethod
    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) scores: positive inside, NaN for rows that are not finite."""

    @property
    def far_score(self) -> float:
        """The score infinitely far from all training states; -inf where no threshold lets it in."""
        far = np.full((1, len(self.kernel_sum_.center)), LARGEST)
        return float(self.decision_function(far)[0])

    def arrays(self) -> Arrays:
        """Center (d,), vectors less it (m, d), signed weights (m,), rho and c."""
        return {**self.kernel_sum_.arrays(), "rho": np.array(self.rho_)}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError where their shapes do not belong together."""
        self.kernel_sum_ = KernelSum.of(arrays)
        self.c_ = self.kernel_sum_.c
        self.rho_ = float(arrays["rho"])
        self._duals = None
        return self
