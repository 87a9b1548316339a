"""The gradient steps of a fit: batches in drawn orders, and a rate that falls to nothing."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from sheath_manip.counting import counted


@dataclass(frozen=True)
class Descent:
    """How a network's loss is brought down, by AdamW (Loshchilov and Hutter 2019)."""

    steps: int
    learning_rate: float
    """at its peak; it falls linearly to 0"""
    batch_size: int
    """states a step; the last batch of an order has what is left"""
    weight_decay: float
    """decoupled"""
    warm_up: bool = False
    """whether the rate rises in the first tenth of the steps, as a transformer wants it"""
    fused: bool = True
    """whether a step of all weights is one operation: faster, and with other low bits"""

    def rate(self, step: int) -> float:
        """Return the learning rate of step 0 .. `steps` - 1."""
        left = 1 - step / self.steps
        risen = 10 * (step + 1) / self.steps if self.warm_up else left
        return self.learning_rate * min(risen, left)

    def run(
        self,
        network: nn.Module,
        samples: int,
        rng: np.random.Generator,
        loss: Callable[[NDArray[np.int64]], torch.Tensor],
    ) -> None:
        """Bring the loss down in place; the network is left ready to predict.

        Args:
            network: that is trained.
            samples: how many there are.
            rng: of the orders; `loss` may draw from it, after each batch is.
            loss: of a batch, (k,) places among the samples.
        """
        # All weights' first operation, then their second: a CPU's default, one weight after the
        # other, gives the same bits in half as long again.
        optimiser = torch.optim.AdamW(
            network.parameters(),
            self.learning_rate,
            weight_decay=self.weight_decay,
            fused=self.fused,
            foreach=not self.fused,
        )
        network.train()
        order = np.empty(0, dtype=np.int64)
        for step in counted(range(self.steps), self.steps):
            if len(order) == 0:
                order = rng.permutation(samples)
            batch, order = order[: self.batch_size], order[self.batch_size :]
            for group in optimiser.param_groups:
                group["lr"] = self.rate(step)
            value = loss(batch)
            optimiser.zero_grad()
            value.backward()
            optimiser.step()
        network.eval()
