"""Nearest neighbours: the distance to the k-th nearest training state.

Knox & Ng 1998, 'Algorithms for mining distance-based outliers in large datasets' (VLDB), which call
a point an outlier where too few others lie within a distance D. Here D is the nu-quantile.
"""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import check_least
from sheath_manip.support.quantile_support import SCORE_BATCH, QuantileSupport


class NeighborSupport(QuantileSupport):
    """Minus the distance to the k-th nearest training vector, in units of the data's spread.

    The boundary comes from the distances of the training vectors to the OTHERS, as a new vector's
    are. All training vectors are kept and searched, so a score costs as they grow.
    """

    def __init__(self, nu: float = 0.05, neighbors: int = 5) -> None:
        """Store the hyperparameters.

        Args:
            nu: in (0, 1]; the share of the training points outside.
            neighbors: k >= 1; fewer where the training points are fewer. At 1 a lone outlier in
                the training data makes its surroundings familiar.
        """
        self.nu = nu
        self.neighbors = neighbors

    def learn(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus each vector's distance to the k-th nearest of the others."""
        check_least({"neighbors": (self.neighbors, 1)})
        self._index(Z)
        return np.concatenate(
            [
                -self._distances(Z[start : start + SCORE_BATCH], start)
                for start in range(0, len(Z), SCORE_BATCH)
            ]
        )

    def rate(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the distance to the k-th nearest training vector."""
        return -self._distances(Z)

    def learned(self) -> Arrays:
        """The (n, d) training vectors."""
        return {"vectors": self.vectors_}

    def take(self, arrays: Arrays) -> None:
        """Take over `learned()`."""
        self._index(np.asarray(arrays["vectors"], dtype=np.float32))

    def _index(self, vectors: NDArray[np.float32]) -> None:
        self.vectors_ = vectors
        self._squares = np.vecdot(vectors, vectors)
        # Laid out so that one row times it runs fastest.
        self._columns = np.ascontiguousarray(-2 * vectors.T)

    def _distances(self, Z: NDArray[np.float32], own: int | None = None) -> NDArray[np.float64]:
        """(n,) to the k-th nearest; vector `own` + i is not a neighbour of row i."""
        # |z - v|² less |z|², which does not matter for who is nearest.
        apart = Z @ self._columns
        apart += self._squares
        if own is not None:
            rows = np.arange(len(Z))
            apart[rows, own + rows] = np.inf
        count = min(self.neighbors, len(self.vectors_) - 1)
        kth = np.partition(apart, count - 1, axis=1)[:, count - 1]
        # Anew from the differences, since the squares' rounding hides small distances.
        gaps = self.vectors_[(apart == kth[:, None]).argmax(axis=1)] - Z
        return np.sqrt(np.vecdot(gaps, gaps), dtype=np.float64)
