"""What is the same for all policies that train a network: how it is fitted, and fitted again."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import ClassVar, Generic, Self, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.descent import Descent
from sheath_manip.policies.network_arrays import placed
from sheath_manip.policies.scaling import Scaling
from sheath_manip.types.samples import Samples

N = TypeVar("N", bound=nn.Module)
Loss = Callable[[NDArray[np.int64]], torch.Tensor]
"""of a batch, (k,) places among the samples"""


class NetworkPolicy(ABC, Generic[N]):
    """A policy whose first fit is cold, and whose later ones go on from the present weights.

    Each fit has a fresh optimiser. With one number of threads the same seed and the same samples in
    the same order give the same weights to the bit.
    """

    seed: int
    """of the initial weights and of the order of the batches"""

    def __init__(self) -> None:
        """Begin unfitted."""
        self.network_: N | None = None
        self.fits_ = 0

    @abstractmethod
    def fresh_network(self, weights: bool = True) -> N:
        """Return one of the seed's first weights; without, it takes no memory and has shapes."""

    @abstractmethod
    def descent(self, samples: int, cold: bool) -> Descent:
        """Return the gradient steps of a fit to so many samples, the first one or a later one."""

    @abstractmethod
    def loss_on(self, network: N, samples: Samples, rng: np.random.Generator) -> Loss:
        """Return the loss that a fit to `samples` brings down; it may draw from `rng`."""

    def before_first_fit(self, samples: Samples) -> None:
        """Learn what comes before all weights, such as the scale of the features: nothing here."""

    def fit(self, samples: Samples) -> Self:
        """Fit to (n, a) labels; ParameterError for none."""
        if len(samples) == 0:
            raise ParameterError(
                "no samples to fit a policy to; at least one labelled state is needed"
            )
        cold, network = self.network_ is None, self.network_
        if network is None:
            self.before_first_fit(samples)
            network = self.network_ = placed(self.fresh_network())
        # Each refit draws its own order of batches.
        rng = np.random.default_rng([self.seed, self.fits_])
        loss = self.loss_on(network, samples, rng)
        self.descent(len(samples), cold).run(network, len(samples), rng, loss)
        self.fits_ += 1
        return self

    def fitted(self) -> N:
        """Return the network; ParameterError where there is none yet."""
        if self.network_ is None:
            raise ParameterError("the policy is not fitted yet; call fit or load first")
        return self.network_


class FeaturePolicy(NetworkPolicy[N]):
    """One that takes the features too, in units of their own, and is fitted by so many steps."""

    warms_up: ClassVar[bool] = False
    """whether the rate of learning rises in the first tenth of a fit"""

    steps: int
    """of a cold fit, however many samples there are"""
    warm_steps: int
    """of a warm refit"""
    learning_rate: float
    warm_learning_rate: float
    batch_size: int
    weight_decay: float

    def __init__(self, scaling: Scaling) -> None:
        """Begin unfitted, with how the features are to be scaled."""
        super().__init__()
        self.scaling_ = scaling

    def before_first_fit(self, samples: Samples) -> None:
        """Learn in which units the features come."""
        self.scaling_.fit(samples.features)

    def descent(self, samples: int, cold: bool) -> Descent:
        """Return `steps` at first and `warm_steps` later, however many samples there are."""
        del samples
        steps, rate = self.warm_steps, self.warm_learning_rate
        if cold:
            steps, rate = self.steps, self.learning_rate
        return Descent(steps, rate, self.batch_size, self.weight_decay, self.warms_up)
