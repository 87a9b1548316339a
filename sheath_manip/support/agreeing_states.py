"""The one-class SVM of the states that the policy gets right: SHIV's idea without its dual.

Training states where the policy errs are left out. That works only where 'right' was judged on
held-out folds: on the states it was fitted to a policy is right nearly everywhere.
"""

from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Arrays
from sheath_manip.support.dual_support import MAX_POINTS
from sheath_manip.support.one_class_svm import OneClassSupport
from sheath_manip.support.vectors import checked_agreement, checked_training


class AgreeingSupport:
    """A `OneClassSupport` that is fitted only to the states in which the policy is right."""

    uses_agreement: ClassVar[bool] = True

    def __init__(
        self,
        nu: float = 0.05,
        bandwidth_factor: float = 1.0,
        max_points: int = MAX_POINTS,
        seed: int = 0,
        bandwidth_unit: str = "median",
    ) -> None:
        """Store the hyperparameters, which are those of `OneClassSupport`."""
        self.nu = nu
        self.bandwidth_factor = bandwidth_factor
        self.max_points = max_points
        self.seed = seed
        self.bandwidth_unit = bandwidth_unit

    def fit(self, X: NDArray, agrees: NDArray | None = None) -> Self:
        """Fit to those of (n, d) vectors where (n,) `agrees`; ParameterError for fewer than 2."""
        X = checked_training(X)
        agrees = checked_agreement(agrees, len(X))
        if agrees.sum() < 2:
            raise ParameterError(
                f"the policy is right in {int(agrees.sum())} of {len(X)} training states; wanted "
                "at least 2: fit it to more demonstrations"
            )
        self.machine_ = self._machine().fit(X[agrees])
        return self

    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) the one-class SVM's scores: positive inside, NaN for rows that are not finite."""
        return self.machine_.decision_function(X)

    @property
    def far_score(self) -> float:
        """The one-class SVM's."""
        return self.machine_.far_score

    def arrays(self) -> Arrays:
        """The one-class SVM's."""
        return self.machine_.arrays()

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        self.machine_ = self._machine().load(arrays)
        return self

    def _machine(self) -> OneClassSupport:
        return OneClassSupport(
            self.nu, self.bandwidth_factor, self.max_points, self.seed, self.bandwidth_unit
        )
