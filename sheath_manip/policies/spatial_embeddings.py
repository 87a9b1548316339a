"""Vectors made of what the continuous image policy sees with all its cameras.

How well each, beside the features at half its weight, tells the last 20 steps before something
topples from the steps of episodes that succeed: AUROC of the distance to the nearest training
state, and the topples before which there is an alarm, 3 to 30 steps ahead, at a threshold that 5 %
of new expert steps fall below. Grasp in clutter, tuning scenes, a policy cloned from 60 clean
demonstrations, which toppled something in 29 of 60 of them and succeeded in 28:

    embedding                            AUROC   alarm before   steps of successes disturbed
    wrist's convolutions, whitened        .81        86 %           17 %
    image points                          .80        69 %           12 %
      whitened                            .77        66 %           12 %
    all convolutions, whitened            .72        31 %            5 %
    last hidden layer                     .74        83 %           24 %
    pixels (12x12), whitened              .65         7 %            4 %
    features alone                        .75        97 %           58 %

The policy that drove hardly ever turned the jaw as the expert would, which is new in every scene;
what is seen from the wrist shows that, and a fixed camera's view is drowned by the new scene.
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
    """The last convolution layer of every camera, or of some, averaged over a square grid."""

    def __init__(
        self, scaling: Scaling | None = None, side: int = 4, cameras: tuple[str, ...] = ()
    ) -> None:
        """Store the hyperparameters.

        Args:
            scaling: of the vectors; standardised where None.
            side: cells of the grid, each way.
            cameras: by name; all of the policy's where none is named.
        """
        super().__init__(scaling)
        self.side = side
        self.cameras = cameras

    def attach(self, policy: Policy) -> None:
        """Look through `policy`; ParameterError where it has no such camera."""
        super().attach(policy)
        for name in self.cameras:
            if name not in self.policy.spec.cameras:
                raise ParameterError(
                    f"{self.policy.spec.name} has no camera {name!r}; it has "
                    f"{', '.join(sorted(self.policy.spec.cameras))}"
                )

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, cameras * channels[-1] * side²), the cameras in the order of their names."""
        layers = self.policy.activations(images)
        pooled = [
            functional.adaptive_avg_pool2d(layers[name], self.side).flatten(1)
            for name in self.cameras or sorted(layers)
        ]
        return torch.cat(pooled, dim=1).numpy()
