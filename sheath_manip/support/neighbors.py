"""Nearest neighbours: the distance to the k-th nearest training state.

Knox & Ng 1998, 'Algorithms for mining distance-based outliers in large datasets' (VLDB), which call
a point an outlier where too few others lie within a distance D. Here D is the nu-quantile.
"""

import numpy as np
from numpy.typing import NDArray
from sklearn.neighbors import NearestNeighbors

from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import check_least
from sheath_manip.support.quantile_support import QuantileSupport


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
        return -self.search_.kneighbors()[0][:, -1].astype(np.float64)

    def rate(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the distance to the k-th nearest training vector."""
        return -self.search_.kneighbors(Z)[0][:, -1].astype(np.float64)

    def learned(self) -> Arrays:
        """The (n, d) training vectors."""
        return {"vectors": self.vectors_}

    def take(self, arrays: Arrays) -> None:
        """Take over `learned()`."""
        self._index(np.asarray(arrays["vectors"], dtype=np.float32))

    def _index(self, vectors: NDArray[np.float32]) -> None:
        self.vectors_ = vectors
        count = min(self.neighbors, len(vectors) - 1)
        # Trees do not pay at the dimensions of an embedding.
        self.search_ = NearestNeighbors(n_neighbors=count, algorithm="brute").fit(vectors)
