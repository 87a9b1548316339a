"""Vectors made of what the continuous image policy sees with all its cameras."""

from typing import final

import numpy as np
from torch.nn import functional

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.embeddings import Images, ScaledEmbedding
from sheath_manip.policies.scaling import Scaling
from sheath_manip.policies.spatial_cnn import SpatialPolicy
from sheath_manip.protocols import Policy


@final
class CameraConvolutions(ScaledEmbedding):
    """The last convolution layer of every camera, or of some, averaged over a square grid."""

    policy: SpatialPolicy

    def __init__(
        self, scaling: Scaling | None = None, side: int = 4, cameras: tuple[str, ...] = ()
    ) -> None:
        """Store the hyperparameters.

        Args:
            scaling: of the vectors; standardised where None.
            side: cells of the grid, each way.
            cameras: to look through; all of the policy's where none is named.
        """
        super().__init__(scaling)
        self.side = side
        self.cameras = cameras

    def attach(self, policy: Policy) -> None:
        """Look through `policy`; ParameterError for one without a convolution layer a camera."""
        if not isinstance(policy, SpatialPolicy):
            raise ParameterError(
                f"embedding CameraConvolutions needs a policy with convolutions of every camera, "
                f"spatial-cnn, not {type(policy).__name__}; use the embedding 'pixels'"
            )
        self.policy = policy

    def vectors(self, images: Images) -> np.ndarray:
        """(n, cameras * channels[-1] * side²), the cameras in the order of their names."""
        layers = self.policy.activations(images)
        return np.concatenate(
            [
                functional.adaptive_avg_pool2d(layers[name], self.side).flatten(1).numpy()
                for name in self.cameras or sorted(layers)
            ],
            axis=1,
        )
