"""The network of the continuous image policy: where each camera sees what, and what to do about it.

Levine et al. 2016, 'End-to-end training of deep visuomotor policies' (JMLR): the last convolution
layer of a camera says for each of its channels where in the picture it responds, as the mean of the
image coordinates under a softmax. What decides a grasp is where things are, and a mean over cells
is finer than the cells. Whether anything stands in a cell it does not say: so the cells go into the
MLP as well (on new scenes of the grasp in clutter they take off a seventh of the squared error).
"""

from collections.abc import Mapping, Sequence

import torch
from torch import nn

from sheath_manip.exceptions import ParameterError

KERNELS = ((5, 3), (3, 2), (3, 1), (3, 1))
"""(side, stride) of each convolution: of those tried on 84 px, with a 9x9 grid at the end. A first
stride of 2 trains at a third of the speed"""

LOOK = 128
"""numbers that are left of all cells"""


class SpatialNetwork(nn.Module):
    """Four convolutions and a spatial softmax a camera, joined with the features in an MLP.

    Takes (n, h, w, 3) uint8 images by camera and (n, f) standardised features.
    """

    def __init__(
        self,
        cameras: Mapping[str, tuple[int, int]],
        features: int,
        outputs: int,
        channels: Sequence[int],
        hidden: Sequence[int],
        generator: torch.Generator | None,
    ) -> None:
        """Draw the first weights from `generator`; ParameterError for images that are too small.

        Without a generator there are only the shapes of the weights, and no memory is taken.

        Args:
            cameras: (height, width) in pixels, by name.
            features: numbers beside the images.
            outputs: numbers to predict.
            channels: filters of each of the four convolutions.
            hidden: width of each hidden layer of the MLP.
            generator: of the first weights.
        """
        super().__init__()
        require_channels(channels)
        require_large_enough(cameras)
        self.cameras = tuple(sorted(cameras))
        # On the meta device the layers' own initialisation draws nothing from the global generator.
        with torch.device("meta"):
            self.eyes = nn.ModuleDict({_module_name(name): Eye(channels) for name in self.cameras})
            cells = sum(side_left(h) * side_left(w) for h, w in cameras.values())
            self.look = nn.Linear(channels[-1] * cells, LOOK)
            widths = (2 * channels[-1] * len(cameras) + LOOK + features, *hidden)
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
        # Channels-last is what the images are, and 1.4 times as fast on a CPU.
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    def activations(
        self, images: Mapping[str, torch.Tensor], dtype=torch.float32
    ) -> dict[str, torch.Tensor]:
        """(n, c, h, w) the last convolution layer's output, before its softmax, by camera."""
        eyes = zip(self.cameras, self.eyes.values(), strict=True)
        return {name: eye(images[name], dtype) for name, eye in eyes}

    def forward(
        self, images: Mapping[str, torch.Tensor], features: torch.Tensor, dtype=torch.float32
    ) -> torch.Tensor:
        """(n, outputs)."""
        return self.outputs(self.activations(images, dtype), features)

    def outputs(self, layers: Mapping[str, torch.Tensor], features: torch.Tensor) -> torch.Tensor:
        """Return the (n, outputs) of the cameras' `activations`."""
        points = [image_points(layer) for layer in layers.values()]
        cells = torch.cat([torch.relu(layer).flatten(1) for layer in layers.values()], dim=1)
        seen = torch.relu(self.look(cells)).float()
        outputs = torch.cat([*points, seen, features], dim=1)
        for layer in self.hidden:
            outputs = torch.relu(layer(outputs))
        return self.head(outputs)


class Eye(nn.Module):
    """The encoder of one camera's image."""

    def __init__(self, channels: Sequence[int]) -> None:
        super().__init__()
        self.convolutions = nn.ModuleList(
            nn.Conv2d(inputs, outputs, side, stride)
            for inputs, outputs, (side, stride) in zip(
                (3, *channels), channels, KERNELS, strict=False
            )
        )

    def forward(self, images: torch.Tensor, dtype=torch.float32) -> torch.Tensor:
        """Return (n, channels[-1], h, w) of (n, H, W, 3) uint8 images."""
        # Centred on 128 the grey values stay exact in bfloat16.
        outputs = images.permute(0, 3, 1, 2).to(dtype).sub_(128).div_(128)
        for number, convolution in enumerate(self.convolutions):
            outputs = convolution(torch.relu(outputs) if number else outputs)
        return outputs


def require_channels(channels: Sequence[int]) -> None:
    """Raise ParameterError unless there is a channel count for each convolution."""
    if len(channels) != len(KERNELS):
        raise ParameterError(
            f"got {len(channels)} convolution layers; wanted {len(KERNELS)} channel counts"
        )


def require_large_enough(cameras: Mapping[str, tuple[int, int]]) -> None:
    """Raise ParameterError where a camera's (height, width) leaves no grid of cells."""
    for name, (height, width) in cameras.items():
        if side_left(min(height, width)) < 2:
            raise ParameterError(
                f"images of {height}x{width} px of camera {name!r} are too small for "
                f"{len(KERNELS)} convolution layers; use larger images"
            )


def image_points(layer: torch.Tensor) -> torch.Tensor:
    """Return (n, 2c) for (n, c, h, w): x, then y, of where each channel responds.

    The image spans -1..1.
    """
    shares = torch.softmax(layer.flatten(2).float(), dim=2).view(layer.shape)
    x = torch.linspace(-1, 1, layer.shape[3], device=layer.device)
    y = torch.linspace(-1, 1, layer.shape[2], device=layer.device)
    return torch.cat([shares.sum(dim=2) @ x, shares.sum(dim=3) @ y], dim=1)


def _module_name(camera: str) -> str:
    """Return the camera's name, or another where a module cannot be called so."""
    taken = "." in camera or hasattr(nn.ModuleDict(), camera)
    return f"camera {camera.replace('.', '/')}" if taken else camera


def side_left(pixels: int) -> int:
    """Return how many cells are left of a side of so many pixels."""
    for side, stride in KERNELS:
        pixels = (pixels - side) // stride + 1
    return pixels
