"""A convolution network that classifies the camera image into the task's admissible actions.

The paper's driving policy is one convolution layer, two fully connected layers and a softmax over
the steering angles (`paper-cnn`); three convolution layers (`cnn`) learn faster and embed better.
"""

from collections.abc import Sequence
from typing import Self

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from sheath_manip.policies.augmentation import drawn_shifts
from sheath_manip.policies.choices import (
    choices_of,
    likeliest,
    nearest_choices,
    zero_one_losses,
)
from sheath_manip.policies.descent import Descent
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.policies.network import ConvNetwork
from sheath_manip.policies.network_arrays import (
    device_of,
    network_with,
    placed,
    tensor_of,
    weights_of,
)
from sheath_manip.policies.network_policy import Loss, NetworkPolicy
from sheath_manip.policies.pictures import pictures_of
from sheath_manip.policies.precision import training_precision
from sheath_manip.policies.reconstruction import reconstruction_loss
from sheath_manip.policies.requirements import require_camera
from sheath_manip.protocols import Arrays
from sheath_manip.types import Observations, Proposal, TaskSpec
from sheath_manip.types.samples import Samples


class ConvPolicy(NetworkPolicy[ConvNetwork], Memoryless):
    """A softmax classifier over `spec.action.choices` from the first camera's image."""

    def __init__(
        self,
        spec: TaskSpec,
        channels: Sequence[int] = (16, 32, 32),
        hidden: Sequence[int] = (128, 64),
        epochs: int = 40,
        warm_epochs: int = 15,
        warm_steps: int = 200,
        learning_rate: float = 2e-3,
        batch_size: int = 128,
        weight_decay: float = 1e-4,
        class_balance: float = 0.5,
        shift_px: int = 2,
        reconstruction_weight: float = 1.0,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters.

        Args:
            spec: of the task; its first camera is the one looked at.
            channels: filters of each convolution layer.
            hidden: width of each fully connected hidden layer.
            epochs: passes over the samples in a cold fit.
            warm_epochs: passes over the samples in a warm refit, at most.
            warm_steps: gradient steps of a warm refit, at most, so that a refit costs the same
                however much data has been aggregated.
            learning_rate: of Adam at its peak; it falls linearly to 0 within each fit. At half of
                it, painting too, the network is left with twice the loss on its own actions.
            batch_size: images a gradient step.
            weight_decay: decoupled (AdamW).
            class_balance: a class weighs as its frequency to the minus this; at 0 each sample
                counts alike, at 1 each class.
            shift_px: most pixels by which an image is moved at random in training. On driving two
                of them (0.4 m) leave two thirds of the costly mistakes that none leave.
            reconstruction_weight: of painting the image back from the last convolution layer,
                beside the cross-entropy, so that what was never seen stays unlike what was; at 0
                nothing is painted, and the network has no decoder.
            seed: of the initial weights and of the order of the batches.
        """
        self.spec = spec
        self.channels = tuple(channels)
        self.hidden = tuple(hidden)
        self.epochs = epochs
        self.warm_epochs = warm_epochs
        self.warm_steps = warm_steps
        self.learning_rate = learning_rate
        self.batch_size = batch_size
        self.weight_decay = weight_decay
        self.class_balance = class_balance
        self.shift_px = shift_px
        self.reconstruction_weight = reconstruction_weight
        self.seed = seed
        self.choices = choices_of(spec)
        require_camera(spec)
        self.camera = next(iter(spec.cameras))
        super().__init__()

    def fresh_network(self, weights: bool = True) -> ConvNetwork:
        """Return one of the seed's first weights; without, it takes no memory and has shapes."""
        return ConvNetwork(
            self.spec.cameras[self.camera],
            len(self.choices),
            self.channels,
            self.hidden,
            torch.Generator().manual_seed(self.seed) if weights else None,
            reconstructs=self.reconstruction_weight > 0,
        )

    def descent(self, samples: int, cold: bool) -> Descent:
        """Return `epochs` at first, and later as many steps as a refit takes at most."""
        batches = -(-samples // self.batch_size)
        warm = min(self.warm_epochs * batches, self.warm_steps)
        steps = self.epochs * batches if cold else warm
        return Descent(steps, self.learning_rate, self.batch_size, self.weight_decay, fused=False)

    def loss_on(self, network: ConvNetwork, samples: Samples, rng: np.random.Generator) -> Loss:
        """Return the cross entropy, each label taken as its nearest choice, and the painting's."""
        device = device_of(network)
        pictures = pictures_of(samples.images[self.camera], device)
        classes = nearest_choices(self.choices, samples.labels)
        counts = np.bincount(classes, minlength=len(self.choices))
        weights = np.maximum(counts, 1.0) ** -self.class_balance
        weights /= weights[classes].mean()
        by_class = torch.as_tensor(weights, dtype=torch.float32, device=device)
        loss_of = nn.CrossEntropyLoss(by_class)

        def loss(batch: NDArray[np.int64]) -> torch.Tensor:
            unmirrored = np.zeros(len(batch), bool)
            shown = pictures.shown(batch, drawn_shifts(unmirrored, self.shift_px, rng))
            with training_precision(device) as dtype:
                last = network.activations(shown, dtype)[-1]
                logits = network.logits(last)
                painted = None if network.decoder is None else network.decoder(last)
            value = loss_of(logits.float(), tensor_of(classes[batch], network))
            if painted is None:
                return value
            return value + self.reconstruction_weight * reconstruction_loss(painted, shown)

        return loss

    def predict(self, observations: Observations) -> Proposal:
        """Take the likeliest choices; features go unused.

        Latents: each convolution layer's (n, c, h, w) output as `convolution 0`, `convolution 1`
        ..., the (n, hidden[-1]) `penultimate` layer, and the (n, k) softmax over the choices as
        `choice scores`.
        """
        network = self.fitted()
        with torch.inference_mode():
            layers = network.activations(tensor_of(observations.images[self.camera], network))
            penultimate = network.rectified(layers[-1])
            logits = network.head(penultimate).cpu()
            scores = torch.softmax(logits, dim=1).numpy()
        latents = {f"convolution {number}": layer.cpu() for number, layer in enumerate(layers)}
        return Proposal(
            likeliest(self.choices, logits.numpy()),
            {**latents, "penultimate": penultimate.cpu(), "choice scores": scores},
        )

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) 1 where predicted and labelled controls differ, else 0 (Eq. 8, righted)."""
        return zero_one_losses(self.choices, proposal.now, labels)

    def untrained(self, seed: int) -> "ConvPolicy":
        """A policy of the same shape with the first weights that belong to `seed`."""
        policy = ConvPolicy(
            self.spec, self.channels, self.hidden, reconstruction_weight=0.0, seed=seed
        )
        policy.network_ = placed(policy.fresh_network()).eval()
        return policy

    def arrays(self) -> Arrays:
        """The weights by layer, those of the decoder included, and the number of fits so far."""
        return {**weights_of(self.fitted()), "fits": np.array(self.fits_)}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()` of a policy of the same shape; ParameterError for another's."""
        weights = {name: array for name, array in arrays.items() if name != "fits"}
        network = network_with(
            weights,
            self.fresh_network,
            f"channels {self.channels}, hidden layers {self.hidden}, {len(self.choices)} choices "
            f"and reconstruction weight {self.reconstruction_weight:g}",
        )
        self.fits_ = int(numbers(arrays, "fits"))
        self.network_ = network
        return self
