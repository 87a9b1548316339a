"""A small network that learns a map on the training states, and is wrong away from them."""

from itertools import pairwise

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from sheath_manip.protocols import Arrays
from sheath_manip.rollout.threads import single_threaded

BATCH = 128
LEARNING_RATE = 3e-3


class BoundedRegression:
    """Linear layers with tanh between, whose outputs never leave the box of the training targets.

    That bound is what makes its error grow without limit far away, as a linear layer's need not.
    """

    def __init__(self, layers: list[tuple[NDArray, NDArray]], box: NDArray) -> None:
        """Take (inputs, outputs) weights and (outputs,) biases a layer, and the (2, out) box."""
        self.layers = [
            (np.asarray(weight, np.float32), np.asarray(bias, np.float32))
            for weight, bias in layers
        ]
        self.box = np.asarray(box, np.float32)

    @classmethod
    def fit(
        cls,
        inputs: NDArray[np.float32],
        targets: NDArray[np.float32],
        hidden: tuple[int, ...],
        steps: int,
        seed: int,
    ) -> "BoundedRegression":
        """Train for `steps` batches of least squares; the same arguments give the same weights.

        Args:
            inputs: (n, d)
            targets: (n, o)
            hidden: width of each hidden layer.
            steps: gradient steps.
            seed: of the first weights and of the order of the batches.
        """
        network = _fresh((inputs.shape[1], *hidden, targets.shape[1]), seed)
        optimiser = torch.optim.AdamW(network.parameters(), LEARNING_RATE)
        rng = np.random.default_rng(seed)
        # Threads would split the sums differently on another machine.
        with single_threaded():
            for step in range(steps):
                for group in optimiser.param_groups:
                    group["lr"] = LEARNING_RATE * (1 - step / steps)
                rows = rng.integers(len(inputs), size=min(BATCH, len(inputs)))
                outputs = network(torch.from_numpy(inputs[rows]))
                loss = nn.functional.mse_loss(outputs, torch.from_numpy(targets[rows]))
                optimiser.zero_grad()
                loss.backward()
                optimiser.step()
        linear = [layer for layer in network if isinstance(layer, nn.Linear)]
        layers = [
            (layer.weight.detach().numpy().T.copy(), layer.bias.detach().numpy().copy())
            for layer in linear
        ]
        return cls(layers, np.stack([targets.min(axis=0), targets.max(axis=0)]))

    def __call__(self, inputs: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (n, o) outputs for (n, d) inputs."""
        # numpy, since torch's overhead on one row is several times the work.
        *before, (weight, bias) = self.layers
        for inner, offset in before:
            inputs = np.tanh(inputs @ inner + offset)
        return np.clip(inputs @ weight + bias, *self.box)

    def errors(
        self, inputs: NDArray[np.float32], targets: NDArray[np.float32]
    ) -> NDArray[np.float64]:
        """(n,) root mean square error over the outputs."""
        return np.sqrt(np.mean((self(inputs) - targets) ** 2, axis=1)).astype(np.float64)

    def arrays(self) -> Arrays:
        """The box, and weights and biases by the layer's number."""
        arrays = {"box": self.box}
        for number, (weight, bias) in enumerate(self.layers):
            arrays |= {f"weight.{number}": weight, f"bias.{number}": bias}
        return arrays

    @classmethod
    def of(cls, arrays: Arrays) -> "BoundedRegression":
        """Make a regression from `arrays()`."""
        count = sum(name.startswith("weight.") for name in arrays)
        layers = [(arrays[f"weight.{i}"], arrays[f"bias.{i}"]) for i in range(count)]
        return cls(layers, arrays["box"])


def _fresh(widths: tuple[int, ...], seed: int) -> nn.Sequential:
    generator = torch.Generator().manual_seed(seed)
    layers: list[nn.Module] = []
    # On the meta device the layers' own initialisation draws nothing from the global generator.
    with torch.device("meta"):
        for inputs, outputs in pairwise(widths):
            layers += [nn.Linear(inputs, outputs), nn.Tanh()]
    network = nn.Sequential(*layers[:-1]).to_empty(device="cpu")
    for parameter in network.parameters():
        if parameter.ndim > 1:
            nn.init.xavier_uniform_(parameter, generator=generator)
        else:
            nn.init.zeros_(parameter)
    return network
