"""How raw vectors are scaled before distances between them mean anything."""

from typing import ClassVar, Protocol, Self

import numpy as np
from numpy.typing import NDArray
from sklearn.covariance import ledoit_wolf

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.protocols import Arrays

# A feature that hardly ever moved in training would be blown up beyond all others by its own tiny
# standard deviation: one faint pixel would then decide what is outside. No feature is magnified
# more than 10 times as much as the median one.
LEAST_RELATIVE_STD = 0.1


class Scaling(Protocol):
    """A fitted map of (n, d) vectors to (n, k <= d) vectors of comparable entries."""

    uses_displaced: ClassVar[bool]
    """whether `fit` needs `displaced`, the vectors of displaced states"""

    def fit(self, X: NDArray, displaced: NDArray | None = None) -> Self:
        """Fit to (n, d) vectors of training states and (m, d) of displaced ones."""
        ...

    def transform(self, X: NDArray) -> NDArray[np.float32]:
        """(n, k) scaled vectors."""
        ...

    def arrays(self) -> Arrays:
        """The learned state."""
        ...

    def load(self, arrays: Arrays) -> Self:
        """Take over a learned state."""
        ...


class Standardisation:
    """Zero mean and unit standard deviation, with a floor for features that (nearly) never move."""

    uses_displaced: ClassVar[bool] = False

    def fit(self, X: NDArray, displaced: NDArray | None = None) -> Self:
        """Fit to (n, d) vectors; ParameterError where they are empty or not finite."""
        del displaced
        X = np.asarray(X, dtype=np.float64)
        if X.ndim != 2 or len(X) == 0 or not np.isfinite(X).all():
            raise ParameterError(
                f"cannot scale vectors of shape {X.shape}; wanted finite (n > 0, d)"
            )
        deviations = X.std(axis=0)
        self.mean_ = X.mean(axis=0).astype(np.float32)
        self.factor_ = (1 / np.maximum(deviations, self._floor(X, deviations))).astype(np.float32)
        return self

    def _floor(self, X: NDArray, deviations: NDArray) -> NDArray | float:
        """Return the least standard deviation to divide by, from (n, d) vectors and their (d,)."""
        del X
        moving = deviations[deviations > 0]
        return LEAST_RELATIVE_STD * float(np.median(moving)) if len(moving) else 1.0

    def transform(self, X: NDArray) -> NDArray[np.float32]:
        """(n, d) standardised vectors."""
        return (np.asarray(X, dtype=np.float32) - self.mean_) * self.factor_

    def arrays(self) -> Arrays:
        """Mean and factor, each (d,)."""
        return {"mean": self.mean_, "factor": self.factor_}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError where their shapes do not belong together."""
        self.mean_ = numbers(arrays, "mean", None).astype(np.float32)
        self.factor_ = numbers(arrays, "factor", len(self.mean_)).astype(np.float32)
        return self


class Whitening:
    """Standardised, then times the inverse root of a shrunk covariance.

    Ledoit & Wolf 2004, 'A well-conditioned estimator for large-dimensional covariance matrices'.
    Where all directions are kept, so are the small ones, since what is unseen may lie there;
    shrinkage stops them exploding.
    """

    uses_displaced: ClassVar[bool] = False

    def __init__(self, most: int | None = None) -> None:
        """Store the hyperparameter; ParameterError where it leaves nothing.

        Args:
            most: directions that are kept, those in which training states vary most; all where
                None. Each step of a robot pays for every one of them.
        """
        if most is not None and most < 1:
            raise ParameterError(f"most is {most}; wanted at least one direction, or None for all")
        self.standardisation = Standardisation()
        self.most = most

    def fit(self, X: NDArray, displaced: NDArray | None = None) -> Self:
        """Fit to (n, d) vectors; ParameterError where they are empty or not finite."""
        del displaced
        vectors, roots = self._directions(X)
        if self.most is None:
            return self._take((vectors / roots) @ vectors.T)
        # They come in rising order.
        return self._take(vectors[:, -self.most :] / roots[-self.most :])

    def _directions(self, X: NDArray) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Standardise (n, d) vectors; (d, d) their directions, and (d,) how wide each is."""
        Z = self.standardisation.fit(X).transform(X).astype(np.float64)
        # The function, since the class inverts what it found, and that takes longer than all this.
        covariance, _ = ledoit_wolf(Z, assume_centered=True)
        values, vectors = np.linalg.eigh(covariance)
        # Shrinkage leaves zero eigenvalues only where nothing moved at all.
        return vectors, np.sqrt(np.maximum(values, 1e-6 * max(float(values[-1]), 1e-6)))

    def transform(self, X: NDArray) -> NDArray[np.float32]:
        """(n, d) whitened vectors."""
        centred = np.asarray(X, np.float32) - self.standardisation.mean_
        return np.asarray(centred @ self._product, np.float32)

    def _take(self, matrix: NDArray) -> Self:
        """Whiten what is standardised by a (d, k) matrix."""
        self.matrix_ = matrix.astype(np.float32)
        # Of one state each step counts, and each pass over memory.
        self._product = self.standardisation.factor_[:, None] * self.matrix_
        return self

    def arrays(self) -> Arrays:
        """Mean and factor, each (d,), and the (d, k) whitening matrix."""
        return {**self.standardisation.arrays(), "matrix": self.matrix_}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError where their shapes do not belong together."""
        self.standardisation.load(arrays)
        width = len(self.standardisation.mean_)
        return self._take(numbers(arrays, "matrix", width, None))
