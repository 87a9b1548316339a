"""The vectors on which the support is estimated.

A network trained only to predict actions maps unseen states onto seen ones in its last layer
(feature collapse); pooled convolutions keep the spatial layout, which cures it.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Self, final

import cv2
import numpy as np
from numpy.typing import NDArray
from torch.nn import functional

from sheath_manip.dataset.samples import Samples
from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.cnn import INFERENCE_BATCH, ConvPolicy
from sheath_manip.policies.scaling import Scaling, Standardisation
from sheath_manip.protocols import Arrays, Policy

Images = Mapping[str, NDArray[np.uint8]]


class ScaledEmbedding(ABC):
    """Raw vectors and the scaling fitted to them.

    It looks through the policy it was fitted on: after the policy's next fit, fit it again.
    """

    def __init__(self, scaling: Scaling | None = None) -> None:
        self.scaling: Scaling = Standardisation() if scaling is None else scaling

    @abstractmethod
    def attach(self, policy: Policy) -> None:
        """Look through `policy` from now on; ParameterError where it lacks what is needed."""

    @abstractmethod
    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, d) raw vectors of at most `INFERENCE_BATCH` images by camera."""

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """Fit the scaling to the training states of `policy`."""
        self.attach(policy)
        self.scaling.fit(self._all_vectors(samples.images))
        return self

    def transform(self, images: Images, features: NDArray) -> NDArray[np.float32]:
        """(n, d) scaled vectors for (n, h, w, 3) images by camera; the features go unused."""
        del features
        return self.scaling.transform(self._all_vectors(images))

    def arrays(self) -> Arrays:
        """The scaling's learned state."""
        return self.scaling.arrays()

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over `arrays()` on top of `policy`."""
        self.attach(policy)
        self.scaling.load(arrays)
        return self

    def _all_vectors(self, images: Images) -> NDArray[np.float32]:
        count = len(next(iter(images.values())))
        if count <= INFERENCE_BATCH:
            return self.vectors(images)
        return np.concatenate(
            [
                self.vectors(
                    {camera: array[i : i + INFERENCE_BATCH] for camera, array in images.items()}
                )
                for i in range(0, count, INFERENCE_BATCH)
            ]
        )


class _ConvolutionalEmbedding(ScaledEmbedding):
    policy: ConvPolicy

    def attach(self, policy: Policy) -> None:
        if not isinstance(policy, ConvPolicy):
            raise ParameterError(
                f"embedding {type(self).__name__} needs a policy with convolutions, "
                f"cnn or paper-cnn, not {type(policy).__name__}; use the embedding 'pixels'"
            )
        self.policy = policy


@final
class Penultimate(_ConvolutionalEmbedding):
    """The network's last layer before the logits, as in the paper; collapses, kept to compare."""

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, hidden[-1])."""
        return self.policy.penultimate(images).numpy()


@final
class PooledConvolutions(_ConvolutionalEmbedding):
    """Every convolution layer's output averaged over a 4x4 grid, one after the other.

    With channels (16, 32, 32) these are 1280 numbers.
    """

    side = 4

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, sum(channels) * 16)."""
        return np.concatenate(
            [
                functional.adaptive_avg_pool2d(layer, self.side).flatten(1).numpy()
                for layer in self.policy.activations(images)
            ],
            axis=1,
        )


@final
class FovealConvolutions(_ConvolutionalEmbedding):
    """The last convolution layer around the middle of the image, at its own resolution.

    For cameras that move with the robot: what decides the next action is near, and there a metre
    counts, while the far field is new in every scene and drowns it. In the driving task, whose last
    layer is 6x6, these are the 2x2 cells that see 7 m around the car: 128 numbers.
    """

    share = 0.5

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, channels[-1] * cells)."""
        layer = self.policy.activations(images)[-1]
        top, left = (round(side * (1 - self.share) / 2) for side in layer.shape[2:])
        middle = layer[:, :, top : layer.shape[2] - top, left : layer.shape[3] - left]
        return middle.flatten(1).numpy()


@final
class Pixels(ScaledEmbedding):
    """Every camera's image shrunk to 16x16 by area; needs nothing of the policy."""

    side = 16

    def attach(self, policy: Policy) -> None:
        """Any policy will do."""

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, cameras * 768), each 0..1, the cameras in the order of their names."""
        size = (self.side, self.side)
        by_camera = [
            np.stack(
                [cv2.resize(image, size, interpolation=cv2.INTER_AREA) for image in images[name]]
            )
            for name in sorted(images)
        ]
        flat = [
            array.reshape(len(array), -1).astype(np.float32) / np.float32(255)
            for array in by_camera
        ]
        return np.concatenate(flat, axis=1)
