"""A convolution network that regresses continuous actions on all cameras and the features."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Self

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional

from sheath_manip.policies.augmentation import drawn_shifts, half_of_them, noisy, reflected
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.policies.network_arrays import (
    device_of,
    network_with,
    tensor_of,
    weights_of,
)
from sheath_manip.policies.network_policy import FeaturePolicy, Loss
from sheath_manip.policies.pictures import pictures_of
from sheath_manip.policies.precision import training_precision
from sheath_manip.policies.requirements import require_camera
from sheath_manip.policies.scaling import Standardisation
from sheath_manip.policies.spatial_network import SpatialNetwork
from sheath_manip.policies.unit_actions import from_unit, to_unit
from sheath_manip.protocols import Arrays
from sheath_manip.types import Observations, Proposal, TaskSpec
from sheath_manip.types.samples import Samples


class SpatialPolicy(FeaturePolicy[SpatialNetwork], Memoryless):
    """Least squares from the images of all cameras and the features to the expert's action.

    Where the task knows no difference between left and right, half of each batch is its own mirror
    image: twice the scenes for the same demonstrations.
    """

    def __init__(
        self,
        spec: TaskSpec,
        channels: Sequence[int] = (16, 32, 32, 32),
        hidden: Sequence[int] = (256, 256),
        steps: int = 1500,
        warm_steps: int = 400,
        learning_rate: float = 1e-3,
        warm_learning_rate: float = 5e-4,
        batch_size: int = 128,
        weight_decay: float = 1e-4,
        shift_px: int = 2,
        feature_noise: float = 0.3,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters; ParameterError where the task has no camera.

        Args:
            spec: of the task; all its cameras are looked at.
            channels: filters of each of the four convolution layers.
            hidden: width of each fully connected hidden layer.
            steps: gradient steps of a cold fit, however many samples there are.
            warm_steps: of a warm refit.
            learning_rate: of Adam at its peak in a cold fit; it falls linearly to 0.
            warm_learning_rate: the same in a warm fit.
            batch_size: states a gradient step.
            weight_decay: decoupled (AdamW).
            shift_px: most pixels by which an image is moved at random in training, each camera's
                by itself.
            feature_noise: standard deviation of what is added to each feature in training, as a
                share of its own. Without it a policy learns from clean demonstrations that a
                gripper which has begun to close goes on closing, wherever it is.
            seed: of the initial weights and of the order of the batches.
        """
        self.spec = spec
        self.channels = tuple(channels)
        self.hidden = tuple(hidden)
        self.steps = steps
        self.warm_steps = warm_steps
        self.learning_rate = learning_rate
        self.warm_learning_rate = warm_learning_rate
        self.batch_size = batch_size
        self.weight_decay = weight_decay
        self.shift_px = shift_px
        self.feature_noise = feature_noise
        self.seed = seed
        require_camera(spec)
        super().__init__(Standardisation())

    def cameras_seen(self) -> tuple[str, ...]:
        """Return the cameras of which a look has a convolution layer: all."""
        return tuple(sorted(self.spec.cameras))

    def loss_on(self, network: SpatialNetwork, samples: Samples, rng: np.random.Generator) -> Loss:
        """Return least squares of actions, each dimension in units of its bounds."""
        felt, device, mirror = replace(samples, images={}), device_of(network), self.spec.mirror
        pictures = {name: pictures_of(samples.images[name], device) for name in network.cameras}

        def loss(batch: NDArray[np.int64]) -> torch.Tensor:
            mirrored = half_of_them(len(batch), mirror, rng)
            states = reflected(felt.take(batch), mirror, mirrored)
            images = {
                name: each.shown(batch, drawn_shifts(mirrored, self.shift_px, rng))
                for name, each in pictures.items()
            }
            features = noisy(self.scaling_.transform(states.features), self.feature_noise, rng)
            with training_precision(device) as dtype:
                outputs = network(images, tensor_of(features, network), dtype)
            targets = tensor_of(to_unit(self.spec.action, states.labels), network)
            return functional.mse_loss(outputs.float(), targets)

        return loss

    def fresh_network(self, weights: bool = True) -> SpatialNetwork:
        """Return one of the seed's first weights; without, it takes no memory and has shapes."""
        return SpatialNetwork(
            self.spec.cameras,
            len(self.spec.feature_names),
            len(self.spec.action.names),
            self.channels,
            self.hidden,
            torch.Generator().manual_seed(self.seed) if weights else None,
        )

    def predict(self, observations: Observations) -> Proposal:
        """Regress actions, cut to their bounds.

        Latents: by camera the last convolution layer's (n, c, h, w) output, as `convolution NAME`.
        """
        network, scaled = self.fitted(), self.scaling_.transform(observations.features)
        images = {name: tensor_of(observations.images[name], network) for name in network.cameras}
        with torch.inference_mode():
            layers = network.activations(images)
            outputs = network.outputs(layers, tensor_of(scaled, network)).cpu().numpy()
        latents = {f"convolution {name}": layer.cpu() for name, layer in layers.items()}
        return Proposal(from_unit(self.spec.action, outputs), latents)

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) the largest deviation of any dimension from its label, as a share of its range.

        Up to `ActionSpec.tolerance` it counts as doing what the expert would.
        """
        return largest_deviations(self.spec.action, proposal.now, labels)

    def arrays(self) -> Arrays:
        """The weights by layer, the scaling of the features and the number of fits so far."""
        weights = weights_of(self.fitted())
        scaling = {f"scaling.{name}": array for name, array in self.scaling_.arrays().items()}
        return {**weights, **scaling, "fits": np.array(self.fits_)}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()` of a policy of the same shape; ParameterError for another's."""
        scaling = {name: arrays[name] for name in arrays if name.startswith("scaling.")}
        others = scaling.keys() | {"fits"}
        weights = {name: array for name, array in arrays.items() if name not in others}
        network = network_with(
            weights,
            self.fresh_network,
            f"channels {self.channels}, hidden layers {self.hidden}, cameras "
            f"{sorted(self.spec.cameras)}, {len(self.spec.feature_names)} features and "
            f"{len(self.spec.action.names)} outputs",
        )
        self.scaling_.load({name.partition(".")[2]: scaling[name] for name in scaling})
        self.fits_ = int(numbers(arrays, "fits"))
        self.network_ = network
        return self
