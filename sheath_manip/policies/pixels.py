"""The image itself as the vector on which the support is estimated."""

from typing import final

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.embeddings import Images, ScaledEmbedding
from sheath_manip.policies.scaling import Scaling
from sheath_manip.protocols import Policy


@final
class Pixels(ScaledEmbedding):
    """Every camera's image, or its middle, shrunk by area; needs nothing of the policy.

    Whitened it is the one to choose where the policy has no convolutions: displaced states of the
    driving task it tells as well as the convolutions do, a car in front less often (AUROC 0.77).
    """

    def __init__(self, scaling: Scaling | None = None, side: int = 16, middle: float = 1.0) -> None:
        """Store the hyperparameters; ParameterError for a side or share that leaves no pixel.

        Args:
            scaling: of the vectors; standardised where None.
            side: pixels of the square image that is left.
            middle: share of the image's sides that is looked at, around its middle; in 0..1.
        """
        super().__init__(scaling)
        if side < 1 or not 0 < middle <= 1:
            raise ParameterError(
                f"side is {side} px and middle {middle}; wanted at least 1 px of a share in 0..1"
            )
        self.side = side
        self.middle = middle

    def attach(self, policy: Policy) -> None:
        """Any policy will do."""

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, cameras * 3 side²), each 0..1, the cameras in the order of their names."""
        size = (self.side, self.side)
        by_camera = [
            np.stack(
                [
                    cv2.resize(image, size, interpolation=cv2.INTER_AREA)
                    for image in self._middle(images[name])
                ]
            )
            for name in sorted(images)
        ]
        flat = [
            array.reshape(len(array), -1).astype(np.float32) / np.float32(255)
            for array in by_camera
        ]
        return np.concatenate(flat, axis=1)

    def _middle(self, images: NDArray[np.uint8]) -> NDArray[np.uint8]:
        top, left = (round(side * (1 - self.middle) / 2) for side in images.shape[1:3])
        return images[:, top : images.shape[1] - top, left : images.shape[2] - left]
