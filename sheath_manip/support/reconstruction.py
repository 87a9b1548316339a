"""A bottleneck network that reproduces the training states, and fails on what is unlike them.

Manevitz & Yousef 2007, 'One-class document classification via neural networks'.
"""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import check_least
from sheath_manip.support.quantile_support import QuantileSupport
from sheath_manip.support.regression import BoundedRegression


class ReconstructionSupport(QuantileSupport):
    """Minus the reconstruction error of a network d → bottleneck → d with tanh in the middle."""

    def __init__(
        self, nu: float = 0.05, bottleneck: int = 32, steps: int = 1000, seed: int = 0
    ) -> None:
        """Store the hyperparameters.

        Args:
            nu: in (0, 1]; the share of the training points outside.
            bottleneck: width of the hidden layer; half of d where that is less, since a wider one
                would copy anything.
            steps: gradient steps.
            seed: of the first weights and of the order of the batches.
        """
        self.nu = nu
        self.bottleneck = bottleneck
        self.steps = steps
        self.seed = seed

    def learn(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the training vectors' errors."""
        check_least({"bottleneck": (self.bottleneck, 1), "steps": (self.steps, 1)})
        width = max(1, min(self.bottleneck, Z.shape[1] // 2))
        self.network_ = BoundedRegression.fit(Z, Z, (width,), self.steps, self.seed)
        return self.rate(Z)

    def rate(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the root mean square difference between vector and reconstruction."""
        return -self.network_.errors(Z, Z)

    def learned(self) -> Arrays:
        """The network's weights."""
        return self.network_.arrays()

    def take(self, arrays: Arrays) -> None:
        """Take over `learned()`."""
        self.network_ = BoundedRegression.of(arrays)
