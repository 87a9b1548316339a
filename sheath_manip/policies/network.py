"""The convolution network of the image policies."""

from collections.abc import Sequence

import torch
from torch import nn

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.reconstruction import Decoder

# (side, stride) of each convolution: those of Mnih et al. 2015, the third at stride 2 for speed.
KERNELS = ((8, 4), (4, 2), (3, 2))


class ConvNetwork(nn.Module):
    """Convolutions, fully connected hidden layers and one logit a class, with ReLU between.

    Takes (n, h, w, 3) uint8 images; `activations` and `rectified` give what lies inside. With
    `reconstructs` a `decoder` paints the image back from the last convolution layer in training.
    """

    def __init__(
        self,
        image_shape: tuple[int, int],
        classes: int,
        channels: Sequence[int],
        hidden: Sequence[int],
        generator: torch.Generator | None,
        reconstructs: bool = False,
    ) -> None:
        """Draw the first weights from `generator`; without one there are only their shapes."""
        super().__init__()
        if not 1 <= len(channels) <= len(KERNELS):
            raise ParameterError(
                f"got {len(channels)} convolution layers; wanted 1 to {len(KERNELS)}"
            )
        height, width = image_shape
        for side, stride in KERNELS[: len(channels)]:
            height, width = (height - side) // stride + 1, (width - side) // stride + 1
        if min(height, width) < 1:
            raise ParameterError(
                f"images of {image_shape[0]}x{image_shape[1]} px are too small for "
                f"{len(channels)} convolution layers; use larger images or fewer channels"
            )
        # On the meta device the layers' own initialisation draws nothing from the global generator.
        with torch.device("meta"):
            self.convolutions = nn.ModuleList(
                nn.Conv2d(inputs, outputs, side, stride)
                for inputs, outputs, (side, stride) in zip(
                    (3, *channels), channels, KERNELS, strict=False
                )
            )
            widths = (channels[-1] * height * width, *hidden)
            self.hidden = nn.ModuleList(
                nn.Linear(inputs, outputs) for inputs, outputs in zip(widths, hidden, strict=False)
            )
            self.head = nn.Linear(widths[-1], classes)
            # Last, so that the other layers begin alike with and without it.
            self.decoder = Decoder(channels[-1]) if reconstructs else None
        if generator is None:
            return
        self.to_empty(device="cpu")
        for parameter in self.parameters():
            if parameter.ndim > 1:
                nn.init.kaiming_uniform_(parameter, nonlinearity="relu", generator=generator)
            else:
                nn.init.zeros_(parameter)
        # Channels-last is what the images are, and 1.4 times as fast on a CPU.
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    def activations(self, images: torch.Tensor, dtype=torch.float32) -> list[torch.Tensor]:
        """[(n, c, h, w)] the output of each convolution layer after its ReLU."""
        # Centred on 128 the grey values stay exact in bfloat16.
        inputs = images.permute(0, 3, 1, 2).to(dtype).sub_(128).div_(128)
        outputs = []
        for convolution in self.convolutions:
            inputs = torch.relu(convolution(inputs))
            outputs.append(inputs)
        return outputs

    def logits(self, last: torch.Tensor) -> torch.Tensor:
        """Return the (n, classes) logits of the last convolution layer's (n, c, h, w) output."""
        return self.head(self.rectified(last))

    def forward(self, images: torch.Tensor, dtype=torch.float32) -> torch.Tensor:
        """(n, classes) logits."""
        return self.logits(self.activations(images, dtype)[-1])

    def rectified(self, last: torch.Tensor) -> torch.Tensor:
        """(n, hidden[-1]) the last layer before the logits, of the last convolution layer."""
        outputs = last.flatten(1)
        for layer in self.hidden:
            outputs = torch.relu(layer(outputs))
        return outputs


def shapes_of(network: nn.Module) -> dict[str, tuple[int, ...]]:
    """Return the shape of each of a network's learned tensors, by name."""
    return {name: tuple(tensor.shape) for name, tensor in network.state_dict().items()}
