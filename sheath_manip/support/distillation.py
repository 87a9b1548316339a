"""Random network distillation: how badly a trained network imitates a random one.

Burda et al. 2019, 'Exploration by random network distillation'; as a gate: RND-DAgger (Biré et al.
2024, 'Efficient active imitation learning with random network distillation').
"""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import check_least
from sheath_manip.support.quantile_support import QuantileSupport
from sheath_manip.support.regression import BoundedRegression

HIDDEN = 128
OUTPUTS = 64


class DistillationSupport(QuantileSupport):
    """Minus the error of a network trained to imitate a fixed random network.

    The random network's ReLU lets its output grow with the distance, while the imitation stays
    within what it saw in training: far away the error has no bound.
    """

    def __init__(self, nu: float = 0.05, steps: int = 1000, seed: int = 0) -> None:
        """Store the hyperparameters.

        Args:
            nu: in (0, 1]; the share of the training points outside.
            steps: gradient steps.
            seed: of the random network, of the other's first weights and of its batches.
        """
        self.nu = nu
        self.steps = steps
        self.seed = seed

    def learn(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the training vectors' errors."""
        check_least({"steps": (self.steps, 1)})
        rng = np.random.default_rng(self.seed)
        # The factor keeps a mean square of 1 through the ReLU (He et al. 2015).
        first = rng.normal(size=(Z.shape[1], HIDDEN)) * np.sqrt(2 / Z.shape[1])
        second = rng.normal(size=(HIDDEN, OUTPUTS)) / np.sqrt(HIDDEN)
        self.target_ = first.astype(np.float32), second.astype(np.float32)
        self.network_ = BoundedRegression.fit(
            Z, self._targets(Z), (HIDDEN, HIDDEN), self.steps, self.seed
        )
        return self.rate(Z)

    def rate(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the root mean square difference between the two networks."""
        return -self.network_.errors(Z, self._targets(Z))

    def learned(self) -> Arrays:
        """The random network's two matrices and the trained network's weights."""
        first, second = self.target_
        return {**self.network_.arrays(), "first": first, "second": second}

    def take(self, arrays: Arrays) -> None:
        """Take over `learned()`."""
        self.target_ = (
            np.asarray(arrays["first"], np.float32),
            np.asarray(arrays["second"], np.float32),
        )
        self.network_ = BoundedRegression.of(arrays)

    def _targets(self, Z: NDArray[np.float32]) -> NDArray[np.float32]:
        first, second = self.target_
        return np.maximum(Z @ first, 0) @ second
