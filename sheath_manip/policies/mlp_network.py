"""The network of the policy that looks at features alone."""

from collections.abc import Sequence

import torch
from torch import nn


class MlpNetwork(nn.Module):
    """Fully connected layers with ReLU between; takes (n, f) standardised features."""

    def __init__(
        self,
        features: int,
        outputs: int,
        hidden: Sequence[int],
        generator: torch.Generator | None,
    ) -> None:
        """Draw the first weights from `generator`; without one there are only their shapes."""
        super().__init__()
        # On the meta device the layers' own initialisation draws nothing from the global generator.
        with torch.device("meta"):
            widths = (features, *hidden)
            self.hidden = nn.ModuleList(
                nn.Linear(inputs, units) for inputs, units in zip(widths, hidden, strict=False)
            )
            self.head = nn.Linear(widths[-1], outputs)
        if generator is None:
            return
        self.to_empty(device="cpu")
        for parameter in self.parameters():
            if parameter.ndim > 1:
                nn.init.kaiming_uniform_(parameter, nonlinearity="relu", generator=generator)
            else:
                nn.init.zeros_(parameter)

    def rectified(self, features: torch.Tensor) -> torch.Tensor:
        """(n, hidden[-1]) the last hidden layer."""
        for layer in self.hidden:
            features = torch.relu(layer(features))
        return features

    def forward(self, features: torch.Tensor) -> torch.Tensor:
        """(n, outputs)."""
        return self.head(self.rectified(features))
