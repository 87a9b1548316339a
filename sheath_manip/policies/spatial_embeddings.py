"""Vectors made of what the continuous image policy sees with all its cameras.

How well the near precedent (`signals/near_precedent.py`) on each, beside the features at half its
weight, tells the last 20 steps before something topples from the steps of episodes that succeed, as
AUROC; the topples before which there is an alarm, 6 to 30 steps ahead, at a threshold that 5 % of
the expert's steps fall below; and the steps of successes that it disturbs. Grasp in clutter, 36
hard tuning scenes, a policy cloned from 60 clean demonstrations, which toppled something in 20:

    embedding                                   AUROC   alarm before   disturbed
    wrist's convolutions on 4x4, whitened        .71        85 %          33 %
      standardised                               .67        80 %          33 %
      on 9x9, whitened                           .68        75 %          30 %
    wrist's pixels (12x12), whitened             .64        30 %          10 %
    image points, standardised                   .57        45 %          29 %

The support alone has .67, 70 % and 29 % on the first, both joined .70, 85 % and 34 %. What is seen
from the wrist matters: a fixed camera's view is drowned by the new scene.

Of the wrist's 512 whitened directions the widest are enough, and the others are noise: the same
AUROC for two other training runs on 60 `medium` tuning scenes each, 31 and 34 of which they failed:

    directions                    512    256    128     64     48     32     24
    near precedent               .825   .852   .871   .885   .893   .899
      the other run              .867                 .891   .897   .896   .886
    joined with the support      .816   .841   .858   .870   .877   .878
      the other run              .866                 .890   .896   .895   .886
"""

from typing import Protocol, final, runtime_checkable

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.embeddings import ScaledEmbedding
from sheath_manip.policies.readings import INSTEAD, CamerasOnGrid, PointsOfCameras, require_named
from sheath_manip.policies.scaling import Scaling
from sheath_manip.protocols import PredictingPolicy, Reader


@runtime_checkable
class LooksThroughCameras(Protocol):
    """A policy of whose looks each camera has a convolution layer, as the latent of its name."""

    def cameras_seen(self) -> tuple[str, ...]:
        """Return the names of the cameras."""
        ...


@final
class ImagePoints(ScaledEmbedding):
    """Where each channel of the last convolution layer responds, in every camera's image.

    The policy's own bottleneck, but one that keeps the space: 64 numbers a camera with 32 channels.
    """

    def __init__(self, scaling: Scaling | None = None, cameras: tuple[str, ...] = ()) -> None:
        """Store the hyperparameters.

        Args:
            scaling: of the vectors; standardised where None.
            cameras: by name; all of the policy's where none is named.
        """
        super().__init__(scaling)
        self.cameras = cameras

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, cameras * 2 channels[-1]); ParameterError where there is no such camera."""
        _require_seen(policy, self.cameras, type(self).__name__)
        return (PointsOfCameras(self.cameras),)


@final
class CameraConvolutions(ScaledEmbedding):
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

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, cameras * channels[-1] * side²); ParameterError where there is no such camera."""
        _require_seen(policy, self.cameras, type(self).__name__)
        return (CamerasOnGrid(self.side, self.cameras),)


def _require_seen(policy: PredictingPolicy, cameras: tuple[str, ...], name: str) -> None:
    if not isinstance(policy, LooksThroughCameras):
        raise ParameterError(
            f"embedding {name} needs a policy with convolutions of every camera, such as "
            f"spatial-cnn and act, not {type(policy).__name__}; use {INSTEAD}"
        )
    require_named(cameras, policy.cameras_seen())
