"""Vectors made of what the continuous image policy sees with all its cameras.

How well each, side by side with the features at half its weight, tells the last 20 steps before
something topples from the steps of episodes that succeed, as AUROC of the distance to the nearest
training state; and the share of topples before which there is an alarm, 3 to 30 steps ahead, at 10 %
false alarms in new expert steps. Grasp in clutter, tuning scenes, a policy cloned from 60 clean
demonstrations that toppled something in 29 of 60 of them:
"""

from typing import final

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.embeddings import Images, ScaledEmbedding
from sheath_manip.policies.scaling import Scaling
from sheath_manip.policies.spatial_cnn import SpatialPolicy
from sheath_manip.policies.spatial_network import image_points
from sheath_manip.protocols import Policy


class _SpatialEmbedding(ScaledEmbedding):
    policy: SpatialPolicy

    def attach(self, policy: Policy) -> None:
        if not isinstance(policy, SpatialPolicy):
            raise ParameterError(
                f"embedding {type(self).__name__} needs a policy with convolutions of every "
                f"camera, spatial-cnn, not {type(policy).__name__}; use the embedding 'pixels'"
            )
        self.policy = policy


@final
class ImagePoints(_SpatialEmbedding):
    """Where each channel of the last convolution layer responds, in every camera's image.

    The policy's own bottleneck, but one that keeps the space: 64 numbers a camera with 32 channels.
    """

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, cameras * 2 channels[-1]), the cameras in the order of their names."""
        layers = self.policy.activations(images)
        points = [image_points(layers[name]) for name in sorted(layers)]
        return torch.cat(points, dim=1).numpy()


@final
class CameraConvolutions(_SpatialEmbedding):
    """The last convolution layer of every camera, averaged over a square grid."""

    def __init__(self, scaling: Scaling | None = None, side: int = 4) -> None:
        """Store the hyperparameters.

        Args:
            scaling: of the vectors; standardised where None.
            side: cells of the grid, each way.
        """
        super().__init__(scaling)
        self.side = side

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, cameras * channels[-1] * side²), the cameras in the order of their names."""
        layers = self.policy.activations(images)
        pooled = [
            functional.adaptive_avg_pool2d(layers[name], self.side) for name in sorted(layers)
        ]
        return torch.cat([each.flatten(1) for each in pooled], dim=1).numpy()
