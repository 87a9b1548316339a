"""Action chunking with a transformer: the next k actions at once from all cameras and the features.

Zhao et al. 2023, 'Learning fine-grained bimanual manipulation with low-cost hardware' (RSS), here
without the variational part, which in the paper makes a difference on people's demonstrations and
none on a script's, and small enough to be trained on a CPU.

From few demonstrations it learns slower than `SpatialPolicy`, whose convolutions it has. The grasp
in clutter, easy tuning scenes, cloned from the same 40 clean demonstrations, 450 steps each:

    policy                                       training loss   succeeds alone
    act, chunks of 8, 4 of them executed             .067            4 of 20
      2 of them executed, or 1                                       2 of 20
    spatial-cnn, twice as many states a step         .045           11 of 20
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Self

import numpy as np
import torch
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.act_network import ActNetwork
from sheath_manip.policies.augmentation import drawn_shifts, half_of_them, noisy, reflected
from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.policies.network_arrays import (
    device_of,
    network_with,
    tensor_of,
    weights_of,
)
from sheath_manip.policies.network_policy import FeaturePolicy, Loss
from sheath_manip.policies.pictures import Pictures, pictures_of
from sheath_manip.policies.precision import training_precision
from sheath_manip.policies.requirements import require_camera, require_continuous
from sheath_manip.policies.scaling import Standardisation
from sheath_manip.policies.unit_actions import from_unit, to_unit
from sheath_manip.protocols import Arrays
from sheath_manip.types import Observations, Proposal, TaskSpec
from sheath_manip.types.history import Chunks, chunk_targets
from sheath_manip.types.samples import Samples


class ActPolicy(FeaturePolicy[ActNetwork]):
    """Regresses the next `chunk` actions, and acts on the first `executed_steps` of them.

    At every step the convolutions look at the present images, so that a gate judges what is seen
    now, by latents as fresh as any; the transformer decodes once a plan, in the first step and
    after `executed_steps` or `replan()`. In training an action behind a gap, such as a change of
    who acts, counts nothing.
    """

    warms_up = True

    def __init__(
        self,
        spec: TaskSpec,
        chunk: int = 8,
        executed_steps: int = 4,
        channels: Sequence[int] = (16, 32, 32, 32),
        width: int = 96,
        heads: int = 4,
        layers: int = 2,
        steps: int = 1500,
        warm_steps: int = 400,
        learning_rate: float = 1e-3,
        warm_learning_rate: float = 5e-4,
        batch_size: int = 64,
        weight_decay: float = 1e-4,
        shift_px: int = 2,
        feature_noise: float = 0.3,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters; ParameterError where the task has no camera or only choices.

        Args:
            spec: of the task; all its cameras are looked at.
            chunk: actions that are predicted at once.
            executed_steps: of a chunk, 1 .. chunk, before the next one is decoded.
            channels: filters of each of the four convolution layers.
            width: of a token of the transformer, a multiple of `heads`.
            heads: of each attention.
            layers: of the encoder, and of the decoder.
            steps: gradient steps of a cold fit, however many samples there are.
            warm_steps: of a warm refit.
            learning_rate: of Adam at its peak in a cold fit; it rises in the first tenth and falls
                linearly to 0.
            warm_learning_rate: the same in a warm fit.
            batch_size: states a gradient step.
            weight_decay: decoupled (AdamW).
            shift_px: most pixels by which an image is moved at random in training, each camera's
                by itself.
            feature_noise: standard deviation of what is added to each feature in training, as a
                share of its own, as in `SpatialPolicy`.
            seed: of the initial weights and of the order of the batches.
        """
        self.spec = spec
        self.chunk = chunk
        self.executed_steps = executed_steps
        self.channels = tuple(channels)
        self.width = width
        self.heads = heads
        self.layers = layers
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
        require_continuous(spec)
        if not 1 <= executed_steps <= chunk:
            raise ParameterError(
                f"executed_steps is {executed_steps}; wanted 1 to the {chunk} actions of a chunk"
            )
        super().__init__(Standardisation())
        self.replan()

    def cameras_seen(self) -> tuple[str, ...]:
        """Return the cameras of which a look has a convolution layer: all."""
        return tuple(sorted(self.spec.cameras))

    def fit(self, samples: Samples) -> Self:
        """Fit to (n, a) labels and those that follow them; ParameterError for none."""
        super().fit(samples)
        self.replan()
        return self

    def loss_on(self, network: ActNetwork, samples: Samples, rng: np.random.Generator) -> Loss:
        """Return the paper's: absolute, which is not drawn to the middle of two ways."""
        targets, device = chunk_targets(samples, self.chunk), device_of(network)
        pictures = {name: pictures_of(samples.images[name], device) for name in network.cameras}
        felt = replace(samples, images={})
        return lambda batch: self._loss(network, pictures, felt, targets, batch, rng)

    def fresh_network(self, weights: bool = True) -> ActNetwork:
        """Return one of the seed's first weights; without, it takes no memory and has shapes."""
        return ActNetwork(
            self.spec.cameras,
            len(self.spec.feature_names),
            len(self.spec.action.names),
            self.chunk,
            self.channels,
            self.width,
            self.heads,
            self.layers,
            torch.Generator().manual_seed(self.seed) if weights else None,
        )

    def _loss(
        self,
        network: ActNetwork,
        pictures: Mapping[str, Pictures],
        samples: Samples,
        targets: Chunks,
        batch: NDArray[np.int64],
        rng: np.random.Generator,
    ) -> torch.Tensor:
        mirrored = half_of_them(len(batch), self.spec.mirror, rng)
        states = self._felt(samples, targets, batch, mirrored)
        images = {
            name: each.shown(batch, drawn_shifts(mirrored, self.shift_px, rng))
            for name, each in pictures.items()
        }
        felt = noisy(self.scaling_.transform(states.features), self.feature_noise, rng)
        with training_precision(device_of(network)) as dtype:
            looked = network.activations(images, dtype)
        # The transformer's gradients take twice as long in half of it.
        layers = {name: layer.float() for name, layer in looked.items()}
        outputs = network(layers, tensor_of(felt, network))
        labels = states.labels.reshape(len(batch), self.chunk, -1)
        off = (outputs - tensor_of(to_unit(self.spec.action, labels), network)).abs()
        known = tensor_of(targets.known[batch], network)
        return off.mean(dim=2)[known].mean()

    def _felt(
        self, samples: Samples, targets: Chunks, batch: NDArray, mirrored: NDArray[np.bool_]
    ) -> Samples:
        """Return a batch without images, `mirrored` ones turned, chunks in place of labels."""
        labels = targets.labels[batch].reshape(len(batch), -1)
        states = replace(samples.take(batch), labels=labels)
        mirror = self.spec.mirror
        if mirror is not None:
            mirror = replace(mirror, action=mirror.action * self.chunk)
        return reflected(states, mirror, mirrored)

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode without a plan; nothing is drawn."""
        del rng
        self.replan()

    def replan(self) -> None:
        """Forget the plan, so that the next step decodes another."""
        self._plan = np.empty((0, len(self.spec.action.names)), np.float32)

    def propose(self, observations: Observations) -> Proposal:
        """Look at the present observation, and propose what is left of the plan, (1, m, a).

        Latents as in `predict`, of the present images; a new plan is decoded only where none is
        left.
        """
        network = self.fitted()
        with torch.inference_mode():
            layers = self._looked(network, observations)
            if not len(self._plan):
                self._plan = self._decoded(network, layers, observations)[0, : self.executed_steps]
        left, self._plan = self._plan, self._plan[1:]
        return Proposal(left[None], _latents(layers))

    def predict(self, observations: Observations) -> Proposal:
        """Regress (n, chunk, a) actions, cut to their bounds; no plan is made or changed.

        Latents: by camera the last convolution layer's (n, c, h, w) output, as `convolution NAME`.
        """
        network = self.fitted()
        with torch.inference_mode():
            layers = self._looked(network, observations)
            chunks = self._decoded(network, layers, observations)
        return Proposal(chunks, _latents(layers))

    def _looked(self, network: ActNetwork, observations: Observations) -> dict[str, torch.Tensor]:
        return network.activations(
            {name: tensor_of(observations.images[name], network) for name in network.cameras}
        )

    def _decoded(
        self, network: ActNetwork, layers: dict[str, torch.Tensor], observations: Observations
    ) -> NDArray[np.float32]:
        """(n, chunk, a)."""
        felt = tensor_of(self.scaling_.transform(observations.features), network)
        return from_unit(self.spec.action, network(layers, felt).cpu().numpy())

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) the largest deviation of any dimension from its label, as a share of its range.

        Of the action for the present step. Up to `ActionSpec.tolerance` it counts as doing what the
        expert would.
        """
        return largest_deviations(self.spec.action, proposal.now, labels)

    def arrays(self) -> Arrays:
        """The weights by layer, the scaling of the features and the number of fits so far."""
        parts = {"network": weights_of(self.fitted()), "scaling": self.scaling_.arrays()}
        return {**flatten(parts), "fits": np.array(self.fits_)}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()` of a policy of the same shape; ParameterError for another's."""
        network = network_with(
            subtree(arrays, "network"),
            self.fresh_network,
            f"channels {self.channels}, chunks of {self.chunk}, {self.layers} layers of width "
            f"{self.width}, cameras {sorted(self.spec.cameras)}, {len(self.spec.feature_names)} "
            f"features and {len(self.spec.action.names)} outputs",
        )
        self.scaling_.load(subtree(arrays, "scaling"))
        self.fits_ = int(numbers(arrays, "fits"))
        self.network_ = network
        self.replan()
        return self


def _latents(layers: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    return {f"convolution {name}": layer.cpu() for name, layer in layers.items()}
