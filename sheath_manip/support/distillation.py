"""Random network distillation: how badly a trained network imitates a random one.

Burda et al. 2019, 'Exploration by random network distillation'; as a gate: RND-DAgger (Biré et al.
2024, 'Efficient active imitation learning with random network distillation').
"""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Arrays
from sheath_manip.support.boundary import check_least
from sheath_manip.support.quantile_support import QuantileSupport
from sheath_manip.support.random_network import HIDDEN, RandomNetwork
from sheath_manip.support.regression import BoundedRegression

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
        self.target_ = RandomNetwork.drawn(Z.shape[1], OUTPUTS, rng)
        self.network_ = BoundedRegression.fit(
            Z, self.target_(Z), (HIDDEN, HIDDEN), self.steps, self.seed
        )
        return self.rate(Z)

    def rate(self, Z: NDArray[np.float32]) -> NDArray[np.float64]:
        """(n,) minus the root mean square difference between the two networks."""
        return -self.network_.errors(Z, self.target_(Z))

    def learned(self) -> Arrays:
        """The random network's two matrices and the trained network's weights."""
        return {**self.network_.arrays(), **self.target_.arrays()}

    def take(self, arrays: Arrays) -> None:
        """Take over `learned()`."""
        self.target_ = RandomNetwork.of(arrays)
        self.network_ = BoundedRegression.of(arrays)
