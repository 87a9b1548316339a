"""A small network for tasks without pictures: from the observation's features to the action."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Self

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.augmentation import half_of_them, noisy, reflected
from sheath_manip.policies.choices import (
    choices_of,
    likeliest,
    nearest_choices,
    zero_one_losses,
)
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.policies.mlp_network import MlpNetwork
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.policies.network_arrays import network_with, tensor_of, weights_of
from sheath_manip.policies.network_policy import FeaturePolicy, Loss
from sheath_manip.policies.own_units import OwnUnits
from sheath_manip.policies.requirements import require_features
from sheath_manip.policies.unit_actions import from_unit, to_unit
from sheath_manip.protocols import Arrays
from sheath_manip.types import Observations, Proposal, TaskSpec
from sheath_manip.types.samples import Samples


class MlpPolicy(FeaturePolicy[MlpNetwork], Memoryless):
    """Regresses continuous actions on the features, or classifies them into choices.

    Images go unused.
    """

    def __init__(
        self,
        spec: TaskSpec,
        hidden: Sequence[int] = (256, 256),
        steps: int = 2000,
        warm_steps: int = 800,
        learning_rate: float = 1e-3,
        warm_learning_rate: float = 5e-4,
        batch_size: int = 128,
        weight_decay: float = 1e-4,
        feature_noise: float = 0.05,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters; ParameterError where the task has no features.

        Args:
            spec: of the task.
            hidden: width of each hidden layer, of which there is at least one.
            steps: gradient steps of a cold fit, however many samples there are.
            warm_steps: of a warm refit.
            learning_rate: of Adam at its peak in a cold fit; it falls linearly to 0.
            warm_learning_rate: the same in a warm fit.
            batch_size: states a gradient step.
            weight_decay: decoupled (AdamW).
            feature_noise: standard deviation of what is added to each feature in training, as a
                share of its own.
            seed: of the initial weights and of the order of the batches.
        """
        self.spec = spec
        self.hidden = tuple(hidden)
        self.steps = steps
        self.warm_steps = warm_steps
        self.learning_rate = learning_rate
        self.warm_learning_rate = warm_learning_rate
        self.batch_size = batch_size
        self.weight_decay = weight_decay
        self.feature_noise = feature_noise
        self.seed = seed
        require_features(spec)
        if not self.hidden:
            raise ParameterError("hidden is empty; wanted a width for each hidden layer, like 256")
        self.choices = None if spec.action.choices is None else choices_of(spec)
        super().__init__(OwnUnits())

    def loss_on(self, network: MlpNetwork, samples: Samples, rng: np.random.Generator) -> Loss:
        """Return least squares, or for choices cross entropy, each label taken as the nearest."""
        seen, mirror = replace(samples, images={}), self.spec.mirror

        def loss(batch: NDArray[np.int64]) -> torch.Tensor:
            states = reflected(seen.take(batch), mirror, half_of_them(len(batch), mirror, rng))
            felt = noisy(self.scaling_.transform(states.features), self.feature_noise, rng)
            return self._loss(network, felt, states.labels)

        return loss

    def fresh_network(self, weights: bool = True) -> MlpNetwork:
        """Return one of the seed's first weights; without, it takes no memory and has shapes."""
        outputs = len(self.spec.action.names) if self.choices is None else len(self.choices)
        return MlpNetwork(
            len(self.spec.feature_names),
            outputs,
            self.hidden,
            torch.Generator().manual_seed(self.seed) if weights else None,
        )

    def _loss(self, network: MlpNetwork, features: NDArray, labels: NDArray) -> torch.Tensor:
        outputs = network(tensor_of(features, network))
        if self.choices is None:
            targets = tensor_of(to_unit(self.spec.action, labels), network)
            return functional.mse_loss(outputs, targets)
        classes = nearest_choices(self.choices, labels)
        return functional.cross_entropy(outputs, tensor_of(classes, network))

    def predict(self, observations: Observations) -> Proposal:
        """Regress actions, cut to their bounds, or take the likeliest choices; images go unused.

        Latents: the (n, hidden[-1]) last hidden layer as `penultimate`, and for choices their
        (n, k) softmax as `choice scores`.
        """
        network, scaled = self.fitted(), self.scaling_.transform(observations.features)
        with torch.inference_mode():
            penultimate = network.rectified(tensor_of(scaled, network))
            outputs = network.head(penultimate).cpu()
        latents = {"penultimate": penultimate.cpu().numpy()}
        if self.choices is None:
            return Proposal(from_unit(self.spec.action, outputs.numpy()), latents)
        scores = torch.softmax(outputs, dim=1).numpy()
        return Proposal(
            likeliest(self.choices, outputs.numpy()), {**latents, "choice scores": scores}
        )

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) for choices 1 where it is another than the label's, else 0.

        For continuous actions the largest deviation of any dimension, as a share of its range.
        """
        if self.choices is None:
            return largest_deviations(self.spec.action, proposal.now, labels)
        return zero_one_losses(self.choices, proposal.now, labels)

    def arrays(self) -> Arrays:
        """The weights by layer, the scaling of the features and the number of fits so far."""
        parts = {"network": weights_of(self.fitted()), "scaling": self.scaling_.arrays()}
        return {**flatten(parts), "fits": np.array(self.fits_)}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()` of a policy of the same shape; ParameterError for another's."""
        network = network_with(
            subtree(arrays, "network"),
            self.fresh_network,
            f"hidden layers {self.hidden}, {len(self.spec.feature_names)} features and "
            f"{len(self.spec.action.names) if self.choices is None else len(self.choices)} outputs",
        )
        self.scaling_.load(subtree(arrays, "scaling"))
        self.fits_ = int(numbers(arrays, "fits"))
        self.network_ = network
        return self
