"""Mahalanobis distance from the training states' mean, under a shrunk covariance.

Ledoit & Wolf 2004, 'A well-conditioned estimator for large-dimensional covariance matrices'; as a
detector of what a network does not know: Lee et al. 2018, 'A simple unified framework for detecting
out-of-distribution samples and adversarial attacks'.
"""

import numpy as np
from numpy.typing import NDArray
from sklearn.covariance import ledoit_wolf

from sheath_manip.protocols import Arrays
from sheath_manip.support.quantile_support import QuantileSupport


class MahalanobisSupport(QuantileSupport):
    """Minus the Mahalanobis distance: one ellipsoid around all training vectors.

    The cheapest of all to score, d² operations however many the training vectors; a support of
    several separate pieces it cannot describe.
    """

    def __init__(self, nu: float = 0.05) -> None:
        """Store `nu` in (0, 1], the share of the training points outside."""
        self.nu = nu

    def learn(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the distances of the training vectors, whose mean is 0."""
        covariance, _ = ledoit_wolf(Z.astype(np.float64), assume_centered=True)
        values, vectors = np.linalg.eigh(covariance)
        # Directions in which the data never moved would have no width, and what leaves the
        # training states along them would be divided by 0.
        widths = np.sqrt(np.maximum(values, 1e-6 * values[-1]))
        self.whitening_ = (vectors / widths).astype(np.float32)
        return self.rate(Z)

    def rate(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the distances."""
        return -np.linalg.norm(Z @ self.whitening_, axis=1).astype(np.float64)

    def learned(self) -> Arrays:
        """The (d, d) matrix under which the training vectors have unit covariance."""
        return {"whitening": self.whitening_}

    def take(self, arrays: Arrays) -> None:
        """Take over `learned()`."""
        self.whitening_ = np.asarray(arrays["whitening"], dtype=np.float32)
