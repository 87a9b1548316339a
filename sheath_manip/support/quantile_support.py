"""What the estimators share that rate vectors but draw no boundary of their own."""

from abc import ABC, abstractmethod
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import check_share, nu_boundary
from sheath_manip.support.vectors import LARGEST, checked_rows, checked_training

# Rows rated at once.
SCORE_BATCH = 1024
# A scaled vector's entries are about 1; sums of squares of these still fit float32.
LARGEST_SCALED = 1e12


class QuantileSupport(ABC):
    """A rating of vectors, less the nu-quantile of the training vectors' ratings.

    A subclass rates scaled vectors: float32 with the training mean at 0 and a mean square of 1 over
    all entries. One factor scales all features alike, so relative distances stay. The rating must
    fall without bound far away, so that no threshold lets in what is far.
    """

    uses_agreement: ClassVar[bool] = False

    nu: float

    @abstractmethod
    def learn(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """Fit to (n, d) scaled vectors; (n,) their ratings."""

    @abstractmethod
    def rate(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) ratings of (n > 0, d) finite scaled vectors, higher where more familiar."""

    @abstractmethod
    def learned(self) -> Arrays:
        """Return what `learn` found."""

    @abstractmethod
    def take(self, arrays: Arrays) -> None:
        """Take over `learned()`."""

    def fit(self, X: NDArray, agrees: NDArray | None = None) -> Self:
        """Fit to (n, d) finite vectors, n >= 2; ParameterError for other data or parameters."""
        del agrees
        check_share("nu", self.nu)
        X = checked_training(X)
        self.center_ = X.mean(axis=0)
        self.scale_ = float(np.sqrt(np.mean((X - self.center_) ** 2)))
        self.boundary_ = nu_boundary(self.learn(self._scaled(X)), self.nu)
        return self

    def decision_function(self, X: NDArray) -> NDArray[np.float64]:
        """(n,) scores, positive inside; a row that is not finite scores NaN."""
        X = checked_rows(X, len(self.center_))
        scores = np.full(len(X), np.nan)
        finite = np.flatnonzero(np.isfinite(X).all(axis=1))
        for start in range(0, len(finite), SCORE_BATCH):
            rows = finite[start : start + SCORE_BATCH]
            scores[rows] = self.rate(self._scaled(X[rows])) - self.boundary_
        return scores

    def arrays(self) -> Arrays:
        """Center (d,), scale and boundary, and what was learned, under names with 'learned.'."""
        own = {f"learned.{name}": array for name, array in self.learned().items()}
        return {
            "center": self.center_,
            "scale": np.array(self.scale_),
            "boundary": np.array(self.boundary_),
            **own,
        }

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError where their shapes do not belong together."""
        self.center_ = np.asarray(arrays["center"], dtype=np.float64)
        self.scale_ = float(arrays["scale"])
        self.boundary_ = float(arrays["boundary"])
        self.take(
            {
                name.removeprefix("learned."): array
                for name, array in arrays.items()
                if name.startswith("learned.")
            }
        )
        try:
            self.rate(np.zeros((1, len(self.center_)), np.float32))
        except ValueError as error:
            raise ParameterError(
                f"the arrays do not rate vectors of width {len(self.center_)}, that of their "
                "center; wanted those of one fitted estimator"
            ) from error
        return self

    def _scaled(self, X: NDArray) -> NDArray[np.float32]:
        near = (np.clip(X, -LARGEST, LARGEST).astype(np.float64) - self.center_) / self.scale_
        return np.clip(near, -LARGEST_SCALED, LARGEST_SCALED).astype(np.float32)
