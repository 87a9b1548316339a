"""What a convolution layer still knows of the image: the image painted back from it.

A network trained for the action alone keeps what decides the action and maps what it never saw onto
what it saw: van Amersfoort et al. 2021, 'On feature collapse and deep kernel learning for single
forward pass uncertainty', who bound its slopes. Having to paint the image as well, its last layer
has to keep what the image shows, so that unseen things stay unlike seen ones.
"""

import cv2
import numpy as np
import torch
from torch import nn
from torch.nn import functional

WIDTH = 32


class Decoder(nn.Sequential):
    """(n, c, h, w) activations to (n, 3, 4h, 4w) pictures, by two transposed convolutions."""

    def __init__(self, channels: int) -> None:
        super().__init__(
            nn.ConvTranspose2d(channels, WIDTH, 2, 2),
            nn.ReLU(),
            nn.ConvTranspose2d(WIDTH, 3, 2, 2),
        )


def reconstruction_loss(pictures: torch.Tensor, images: torch.Tensor) -> torch.Tensor:
    """() the mean squared error of (n, 3, h, w) pictures, in units of 64 grey levels.

    Their target is what (n, H, W, 3) uint8 images show, averaged by area to the same h and w.
    """
    target = _averaged(images, pictures.shape[2], pictures.shape[3])
    return functional.mse_loss(pictures.float(), (target - 128) / 64)


def _averaged(images: torch.Tensor, height: int, width: int) -> torch.Tensor:
    """(n, 3, height, width) means by area."""
    if images.device.type != "cpu":
        return functional.adaptive_avg_pool2d(images.permute(0, 3, 1, 2).float(), (height, width))
    # In half the time of torch's adaptive pooling on a CPU.
    averaged = [
        cv2.resize(image, (width, height), interpolation=cv2.INTER_AREA) for image in images.numpy()
    ]
    return torch.from_numpy(np.stack(averaged)).permute(0, 3, 1, 2).float()
