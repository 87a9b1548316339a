"""What is taken of a look: readers, each a small value, so that equal ones share the reading."""

import math
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NoReturn

import numpy as np
import torch
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.shrinking import averaging, shrinking
from sheath_manip.policies.spatial_network import image_points
from sheath_manip.protocols import PredictingPolicy, Reader
from sheath_manip.types import Observations, Proposal, TaskSpec

MIDDLE = 0.5
"""share of a layer's sides that lies around the middle of the image"""
NAMED_BY = "--gate.embedding, --gate.precedent-embedding"
"""the options that name embeddings"""
INSTEAD = f"the embedding 'pixels', or 'scaled-features' where there is no camera: {NAMED_BY}"
"""embeddings that do for any policy"""
CONVOLUTION = "convolution "
"""what the latents of convolution layers are called, and then their number or camera"""


NO_CAMERA = (
    "there is no camera whose pixels could be looked at; wanted a task with one, or "
    f"the embedding 'scaled-features': {NAMED_BY}"
)


def numbered_layer(proposal: Proposal, number: int) -> torch.Tensor:
    """(n, c, h, w) what a convolution layer of one camera made of the image.

    Raises ParameterError where the policy has none of that number.
    """
    found = proposal.latents.get(f"{CONVOLUTION}{number}")
    return _refuse(proposal, "cnn") if found is None else found


def last_numbered_layer(proposal: Proposal) -> torch.Tensor:
    """(n, c, h, w) what the last one made of it; ParameterError where there is none."""
    number = 0
    while f"{CONVOLUTION}{number + 1}" in proposal.latents:
        number += 1
    return numbered_layer(proposal, number)


def layers_by_camera(proposal: Proposal) -> dict[str, torch.Tensor]:
    """Return (n, c, h, w) by camera, what its last convolution layer made of the image.

    Raises ParameterError where the policy has none such.
    """
    found = {
        camera: layer
        for name, layer in proposal.latents.items()
        if name.startswith(CONVOLUTION)
        and not (camera := name.removeprefix(CONVOLUTION)).isdecimal()
    }
    return found or _refuse(proposal, "spatial-cnn")


def _refuse(proposal: Proposal, wanted: str) -> NoReturn:
    raise ParameterError(
        "the embedding needs a policy with convolutions to look through, such as "
        f"{wanted}; this one gives {', '.join(sorted(proposal.latents)) or 'nothing'}; use that "
        f"policy, or {INSTEAD}"
    )


@dataclass(frozen=True)
class Latent:
    """A latent of (n, d), as it is."""

    name: str

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, d); ParameterError where the policy gives none of that name."""
        del observations
        if self.name not in proposal.latents:
            raise ParameterError(
                f"the policy gives no {self.name!r} of what it sees; it gives "
                f"{', '.join(sorted(proposal.latents)) or 'nothing'}"
            )
        return np.asarray(proposal.latents[self.name])


@dataclass(frozen=True)
class MiddleOfLastLayer:
    """The last convolution layer's cells around the middle of the image, at its own resolution."""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, channels[-1] * cells)."""
        del observations
        layer = last_numbered_layer(proposal).numpy()
        middle = layer[:, :, _middle(layer.shape[2]), _middle(layer.shape[3])]
        return middle.reshape(len(middle), math.prod(middle.shape[1:]))


@dataclass(frozen=True)
class LayerOnGrid:
    """What a convolution layer shows in each cell of a square grid, on average."""

    layer: int
    """its number, from 0"""
    side: int
    """cells of the grid, each way"""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, c * side²)."""
        del observations
        return _on_grid(numbered_layer(proposal, self.layer), self.side)


@dataclass(frozen=True)
class CamerasOnGrid:
    """Every camera's convolution layer, or some cameras', averaged over a square grid."""

    side: int
    """cells of the grid, each way"""
    cameras: tuple[str, ...] = ()
    """all, in the order of their names, where none is named"""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, cameras * c * side²)."""
        del observations
        layers = _of_cameras(layers_by_camera(proposal), self.cameras)
        return np.concatenate([_on_grid(layer, self.side) for layer in layers], axis=1)


@dataclass(frozen=True)
class PointsOfCameras:
    """Where each channel of every camera's convolution layer, or some cameras', responds."""

    cameras: tuple[str, ...] = ()
    """all, in the order of their names, where none is named"""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, cameras * 2 c)."""
        del observations
        layers = _of_cameras(layers_by_camera(proposal), self.cameras)
        return torch.cat([image_points(layer) for layer in layers], dim=1).numpy()


@dataclass(frozen=True)
class ShrunkPixels:
    """Every camera's image, or some cameras', or its middle, shrunk by area."""

    side: int
    """pixels of the square image that is left"""
    middle: float
    """share of the image's sides that is looked at, around its middle; in 0..1"""
    cameras: tuple[str, ...] = ()
    """all, in the order of their names, where none is named"""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, cameras * 3 side²), each 0..1."""
        del proposal
        images = _of_cameras(observations.images, self.cameras)
        return np.concatenate([self._of_camera(each) for each in images], axis=1)

    def _of_camera(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        height, width = images.shape[1:3]
        shrunk = shrinking(height, width, self.side, self.middle).shrink(images)
        return shrunk / np.float32(255)


@dataclass(frozen=True)
class ObservedFeatures:
    """`Observation.features` as they are."""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, f)."""
        del proposal
        return np.asarray(observations.features, dtype=np.float32)


@dataclass(frozen=True)
class SeenFromTool:
    """What another reader takes of what an egocentric policy was shown."""

    reader: Reader

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """Return the other reader's reading.

        Raises ParameterError where the policy does not look from a tool.
        """
        del observations
        latents = proposal.latents
        if "tool images" not in latents:
            raise ParameterError(
                "an embedding of what is seen from the tool needs the policy egocentric-cnn; "
                f"wanted that policy, or {INSTEAD}"
            )
        shown = Observations(latents["tool images"], latents["tool features"])
        return self.reader(shown, proposal)


@dataclass(frozen=True, eq=False)
class ThroughAnotherPolicy:
    """What other readers take, side by side, of the same images in another policy's eyes."""

    policy: PredictingPolicy
    readers: tuple[Reader, ...]
    """all that is taken of the look, so that the other policy looks once too"""

    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, d) the sum of the other readers' numbers."""
        del proposal
        other = self.policy.predict(observations)
        return np.concatenate([reader(observations, other) for reader in self.readers], axis=1)


OF_CAMERAS = (MiddleOfLastLayer, LayerOnGrid, CamerasOnGrid, PointsOfCameras, ShrunkPixels)
"""readers of what cameras see"""


def require_cameras(readers: Iterable[Reader], spec: TaskSpec) -> None:
    """Raise ParameterError where any of `readers` wants a camera that the task has not."""
    for each in readers:
        if isinstance(each, OF_CAMERAS):
            require_named(getattr(each, "cameras", ()), spec.cameras)


def require_named(wanted: Iterable[str], cameras: Collection[str]) -> None:
    """Raise ParameterError unless there are `cameras`, and those that are `wanted` among them."""
    if not cameras:
        raise ParameterError(NO_CAMERA)
    there = ",".join(sorted(cameras))
    for name in wanted:
        if name not in cameras:
            raise ParameterError(
                f"there is no camera {name!r} for an embedding to look through, there is {there}; "
                f"name those to be looked through behind it, 'camera-convolutions:{there}': "
                f"{NAMED_BY}"
            )


def _of_cameras(by_camera: Mapping[str, Any], wanted: tuple[str, ...]) -> list[Any]:
    """Return what there is of the cameras that are `wanted`, of all where none is named."""
    require_named(wanted, by_camera)
    return [by_camera[name] for name in wanted or sorted(by_camera)]


def _on_grid(layer: torch.Tensor, side: int) -> NDArray[np.float32]:
    """Return (n, c * side²), the means of an (n, c, h, w) layer over the cells of a grid."""
    count, channels, height, width = layer.shape
    # Channels come last in memory.
    cells = layer.numpy().transpose(0, 2, 3, 1).reshape(count, height * width, channels)
    means = averaging(height, width, side) @ cells
    return means.transpose(0, 2, 1).reshape(count, channels * side**2)


@lru_cache(maxsize=64)
def _middle(side: int) -> slice:
    """Return the middle of a layer's side."""
    beyond = round(side * (1 - MIDDLE) / 2)
    return slice(beyond, side - beyond)


def each_once(readers: Iterable[Reader]) -> tuple[Reader, ...]:
    """Return all of `readers` without those that are equal to an earlier one."""
    return tuple(dict.fromkeys(readers))
