"""Batches of training images where the network is, mirrored and moved as they were drawn."""

from typing import Protocol

import numpy as np
import torch
from numpy.typing import NDArray

from sheath_manip.policies.augmentation import Moves, moved

CHUNK = 4096
"""images that are copied to a device at once: mapped ones are read from files"""
FREE_SHARE = 0.5
"""of a device's free memory that images may fill; the rest is for weights and activations"""


class Pictures(Protocol):
    """Images of one camera, of which a gradient step looks at a batch."""

    def shown(self, batch: NDArray[np.int64], moves: Moves) -> torch.Tensor:
        """Return the (k, h, w, 3) uint8 images of a batch, moved."""
        ...


class HostPictures:
    """Images in the memory of the CPU, from where each batch is copied."""

    def __init__(self, images: NDArray[np.uint8], device: torch.device) -> None:
        """Take the (n, h, w, 3) images, and where batches are wanted."""
        self._images, self._device = images, device

    def shown(self, batch: NDArray[np.int64], moves: Moves) -> torch.Tensor:
        """Return the (k, h, w, 3) uint8 images of a batch, moved."""
        pictures = torch.from_numpy(moved(self._images[batch], moves))
        return pictures.to(self._device, non_blocking=True)


class ResidentPictures:
    """Images on the device itself: of a batch only its places and moves travel."""

    def __init__(self, images: NDArray[np.uint8], device: torch.device) -> None:
        """Copy the (n, h, w, 3) images there."""
        self._images = torch.empty(images.shape, dtype=torch.uint8, device=device)
        for first in range(0, len(images), CHUNK):
            some = slice(first, first + CHUNK)
            self._images[some] = torch.from_numpy(np.array(images[some]))

    def shown(self, batch: NDArray[np.int64], moves: Moves) -> torch.Tensor:
        """Return the (k, h, w, 3) uint8 images of a batch, moved: bytes as `moved` gives them."""
        height, width = self._images.shape[1:3]
        device = self._images.device
        places = torch.from_numpy(batch).to(device)
        down, right = torch.from_numpy(moves.offsets).to(device).T
        rows = (torch.arange(height, device=device) - down[:, None]) % height
        columns = (torch.arange(width, device=device) - right[:, None]) % width
        mirrored = torch.from_numpy(moves.mirrored).to(device)
        columns = torch.where(mirrored[:, None], width - 1 - columns, columns)
        return self._images[places[:, None, None], rows[:, :, None], columns[:, None, :]]


def pictures_of(images: NDArray[np.uint8], device: torch.device) -> Pictures:
    """Return batches of (n, h, w, 3) images for `device`, kept on it where they fit."""
    if device.type == "cuda":
        free, _ = torch.cuda.mem_get_info(device)
        if images.nbytes <= FREE_SHARE * free:
            return ResidentPictures(images, device)
    return HostPictures(images, device)
