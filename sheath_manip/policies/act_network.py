"""The network that decodes a chunk of actions from all cameras and the features at once."""

from collections.abc import Mapping, Sequence

import torch
from torch import nn
from torch.nn import functional

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.spatial_network import (
    Eye,
    image_points,
    require_channels,
    require_large_enough,
    side_left,
)

CELLS = 5
"""a side, into which a camera's grid is pooled where it is finer: attention over all 81 cells of an
image of 84 px takes three times as long. What is finer, the trunk tells"""
TRUNK = 256
"""hidden units between where things are and the first guess"""
FEED_FORWARD = 2
"""times the width is the hidden layer of each block"""


class ActNetwork(nn.Module):
    """Convolutions a camera, a transformer over their cells, and one query an action of the chunk.

    Takes (n, h, w, 3) uint8 images by camera and (n, f) standardised features. Where each channel
    of each camera responds, finer than the cells are, goes with the features through a trunk of its
    own, which says the whole chunk at a first guess; the transformer, to which it is a token beside
    the cells, adds what the guess lacks, at first nothing. So it learns from few demonstrations
    what `SpatialNetwork` does.
    """

    def __init__(
        self,
        cameras: Mapping[str, tuple[int, int]],
        features: int,
        outputs: int,
        chunk: int,
        channels: Sequence[int],
        width: int,
        heads: int,
        layers: int,
        generator: torch.Generator | None,
    ) -> None:
        """Draw the first weights from `generator`; without one there are only their shapes.

        Args:
            cameras: (height, width) in pixels, by name.
            features: numbers beside the images.
            outputs: numbers of an action.
            chunk: actions to predict.
            channels: filters of each of the four convolutions.
            width: of a token.
            heads: of each attention.
            layers: of the encoder, and of the decoder.
            generator: of the first weights.
        """
        super().__init__()
        require_channels(channels)
        require_large_enough(cameras)
        self.cameras = tuple(sorted(cameras))
        # Of the cells of all cameras, and one of all that the trunk says.
        tokens = sum(_pooled(high) * _pooled(wide) for high, wide in cameras.values()) + 1
        # On the meta device the layers' own initialisation draws nothing from the global generator.
        with torch.device("meta"):
            # Lists, since a module cannot be called what a camera can.
            self.eyes = nn.ModuleList(Eye(channels) for _ in self.cameras)
            self.cell = nn.Linear(channels[-1], width)
            look = 2 * channels[-1] * len(cameras) + features
            self.trunk = nn.ModuleList((nn.Linear(look, TRUNK), nn.Linear(TRUNK, TRUNK)))
            self.direct = nn.Linear(TRUNK, chunk * outputs)
            self.said = nn.Linear(TRUNK, width)
            self.places = nn.Parameter(torch.empty(tokens, width))
            self.queries = nn.Parameter(torch.empty(chunk, width))
            self.encoder = nn.ModuleList(Block(width, heads) for _ in range(layers))
            self.decoder = nn.ModuleList(Block(width, heads, crosses=True) for _ in range(layers))
            self.norm = nn.LayerNorm(width)
            self.head = nn.Linear(width, outputs)
        if generator is None:
            return
        self.to_empty(device="cpu")
        for name, parameter in self.named_parameters():
            if "norm" in name:
                nn.init.constant_(parameter, float(name.endswith("weight")))
            elif name in ("places", "queries"):
                nn.init.normal_(parameter, std=0.1, generator=generator)
            elif name == "head.weight":
                nn.init.zeros_(parameter)
            elif name.startswith(("eyes", "trunk")) and parameter.ndim > 1:
                nn.init.kaiming_uniform_(parameter, nonlinearity="relu", generator=generator)
            elif parameter.ndim > 1:
                nn.init.xavier_uniform_(parameter, generator=generator)
            else:
                nn.init.zeros_(parameter)
        # Channels-last is what the images are, and 1.4 times as fast on a CPU.
        self.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]

    def activations(
        self, images: Mapping[str, torch.Tensor], dtype=torch.float32
    ) -> dict[str, torch.Tensor]:
        """(n, c, h, w) the last convolution layer's output, by camera."""
        eyes = zip(self.cameras, self.eyes, strict=True)
        return {name: eye(images[name], dtype) for name, eye in eyes}

    def forward(self, layers: Mapping[str, torch.Tensor], features: torch.Tensor) -> torch.Tensor:
        """Return the (n, chunk, outputs) of the cameras' `activations`."""
        points = [image_points(layers[name]) for name in self.cameras]
        said = torch.cat([*points, features], dim=1)
        for layer in self.trunk:
            said = torch.relu(layer(said))
        cells = [self.cell(_cells(layers[name])) for name in self.cameras]
        tokens = torch.cat([*cells, self.said(said)[:, None]], dim=1) + self.places
        for block in self.encoder:
            tokens = block(tokens, tokens)
        chunk = self.queries.expand(len(features), -1, -1)
        for block in self.decoder:
            chunk = block(chunk, tokens)
        return self.direct(said).unflatten(1, (len(self.queries), -1)) + self.head(self.norm(chunk))


def _pooled(side_px: int) -> int:
    """Return how many cells are left of an image's side."""
    return min(side_left(side_px), CELLS)


def _cells(layer: torch.Tensor) -> torch.Tensor:
    """(n, cells, c) of (n, c, h, w), pooled."""
    high, wide = layer.shape[2:]
    sides = min(high, CELLS), min(wide, CELLS)
    return functional.adaptive_avg_pool2d(torch.relu(layer), sides).flatten(2).mT


class Block(nn.Module):
    """Attention and two layers, each added to what came in, which is normalised before.

    One that crosses looks from the chunk at itself, and then at the tokens.
    """

    def __init__(self, width: int, heads: int, crosses: bool = False) -> None:
        super().__init__()
        self.itself = Attention(width, heads)
        self.norm_itself = nn.LayerNorm(width)
        self.other = Attention(width, heads) if crosses else None
        self.norm_other = nn.LayerNorm(width) if crosses else None
        self.wide = nn.Linear(width, FEED_FORWARD * width)
        self.narrow = nn.Linear(FEED_FORWARD * width, width)
        self.norm = nn.LayerNorm(width)

    def forward(self, tokens: torch.Tensor, memory: torch.Tensor) -> torch.Tensor:
        """(n, t, width) of (n, t, width) tokens and (n, m, width) to look at."""
        normal = self.norm_itself(tokens)
        tokens = tokens + self.itself(normal, normal)
        if self.other is not None and self.norm_other is not None:
            tokens = tokens + self.other(self.norm_other(tokens), memory)
        return tokens + self.narrow(torch.relu(self.wide(self.norm(tokens))))


class Attention(nn.Module):
    """Scaled dot-product attention of several heads."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        if width % heads:
            raise ParameterError(f"width is {width}; wanted a multiple of the {heads} heads")
        self.heads = heads
        self.query = nn.Linear(width, width)
        self.key = nn.Linear(width, width)
        self.value = nn.Linear(width, width)
        self.out = nn.Linear(width, width)

    def forward(self, tokens: torch.Tensor, memory: torch.Tensor) -> torch.Tensor:
        """(n, t, width) what each token takes from the (n, m, width) memory."""
        query, key, value = (
            layer(rows).unflatten(2, (self.heads, -1)).transpose(1, 2)
            for layer, rows in ((self.query, tokens), (self.key, memory), (self.value, memory))
        )
        taken = functional.scaled_dot_product_attention(query, key, value)
        return self.out(taken.transpose(1, 2).flatten(2))
