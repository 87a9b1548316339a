"""Policies and embeddings of the table that are others with settings of their own."""

from functools import partial

from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.policies.contrast_whitening import ContrastWhitening
from sheath_manip.policies.convolutional_embeddings import (
    FovealConvolutions,
    Penultimate,
    PooledConvolutions,
    TwoScaleConvolutions,
)
from sheath_manip.policies.features import ScaledFeatures
from sheath_manip.policies.latent import LatentEmbedding
from sheath_manip.policies.linear_svm import LinearSvm
from sheath_manip.policies.own_units import OwnUnits
from sheath_manip.policies.pixels import Pixels
from sheath_manip.policies.scaling import Whitening
from sheath_manip.policies.side_by_side import SideBySide
from sheath_manip.policies.spatial_embeddings import CameraConvolutions, ImagePoints
from sheath_manip.policies.tool_view_embedding import FromTool
from sheath_manip.protocols import Embedding

# For the action alone, without the painting, the lower rate is enough.
plain_cnn = partial(ConvPolicy, learning_rate=1e-3, reconstruction_weight=0.0)
paper_cnn = partial(plain_cnn, channels=(16,))
# Ross et al. 2011 and the draft.
linear_svm_paper = partial(LinearSvm, penalty=0.01)


def two_scale_contrasts() -> TwoScaleConvolutions:
    """The policy's convolutions, fine and coarse, in the directions of most contrast."""
    return TwoScaleConvolutions(ContrastWhitening(most=64), side=4)


def foveal_contrasts() -> FovealConvolutions:
    """The policy's convolutions in the image's middle, in the directions of most contrast."""
    return FovealConvolutions(ContrastWhitening(most=32))


def convolutions_and_pixels() -> SideBySide:
    """Embed what the policy makes of the image, the image itself, and its middle more closely.

    Of two views that know different things the joined distances know both: the whole image that the
    robot stands askew, its middle what is near.
    """
    return SideBySide(
        {
            "convolutions": TwoScaleConvolutions(ContrastWhitening()),
            "pixels": Pixels(Whitening()),
            "middle": Pixels(ContrastWhitening(), side=12, middle=0.4),
        },
        {"convolutions": 1.0, "pixels": 2.0, "middle": 1.0},
    )


def two_scale_convolutions() -> TwoScaleConvolutions:
    """The policy's convolutions, fine and coarse, their contrasts whitened."""
    return TwoScaleConvolutions(ContrastWhitening())


def foveal_convolutions() -> FovealConvolutions:
    """The policy's convolutions, fine in the image's middle, their contrasts whitened."""
    return FovealConvolutions(ContrastWhitening())


def foveal_convolutions_whitened() -> FovealConvolutions:
    """The policy's convolutions, fine in the image's middle, whitened."""
    return FovealConvolutions(Whitening())


def pooled_convolutions_whitened() -> PooledConvolutions:
    """The policy's last convolutions, pooled and whitened."""
    return PooledConvolutions(Whitening())


def pixels_whitened(cameras: tuple[str, ...] = ()) -> Pixels:
    """The image itself, small and whitened."""
    return Pixels(Whitening(), cameras=cameras)


def latent_whitened() -> LatentEmbedding:
    """What a layer of the policy shows, whitened."""
    return LatentEmbedding(Whitening())


def _and_features(seen: Embedding) -> SideBySide:
    """What the cameras see, and what the robot feels of itself."""
    return SideBySide({"seen": seen, "felt": ScaledFeatures()}, {"seen": 2.0, "felt": 1.0})


def scaled_features() -> ScaledFeatures:
    """Embed the features, each in a unit of its own."""
    return ScaledFeatures(OwnUnits())


def mlp_hidden() -> SideBySide:
    """What the policy makes of the features in its last hidden layer, and the features."""
    return SideBySide(
        {"made": Penultimate(), "felt": scaled_features()}, {"made": 1.0, "felt": 1.0}
    )


def image_points(cameras: tuple[str, ...] = ()) -> SideBySide:
    """Embed where the policy looks in its cameras, and the features."""
    return _and_features(ImagePoints(cameras=cameras))


def image_points_whitened(cameras: tuple[str, ...] = ()) -> SideBySide:
    """Embed where the policy looks in its cameras, whitened, and the features."""
    return _and_features(ImagePoints(Whitening(), cameras))


def camera_convolutions(cameras: tuple[str, ...] = ()) -> SideBySide:
    """The convolutions of every camera, and the features."""
    return _and_features(CameraConvolutions(cameras=cameras))


def camera_convolutions_whitened(cameras: tuple[str, ...] = ()) -> SideBySide:
    """The convolutions of every camera, whitened, and the features."""
    return _and_features(CameraConvolutions(Whitening(), cameras=cameras))


def wrist_convolutions() -> SideBySide:
    """The convolutions of the camera at the wrist, in their widest directions, and the features."""
    return _and_features(CameraConvolutions(Whitening(most=48), cameras=("wrist",)))


def pixels_and_features(cameras: tuple[str, ...] = ()) -> SideBySide:
    """The images themselves, small and whitened, and the features."""
    return _and_features(Pixels(Whitening(), side=12, cameras=cameras))


def tool_points() -> FromTool:
    """Embed where the policy looks, in the tool's frame."""
    return FromTool(ImagePoints())


def tool_points_whitened() -> FromTool:
    """Embed where the policy looks, in the tool's frame, whitened."""
    return FromTool(ImagePoints(Whitening()))


def tool_convolutions() -> FromTool:
    """The convolutions of the picture in the tool's frame."""
    return FromTool(CameraConvolutions())


def tool_convolutions_whitened() -> FromTool:
    """The convolutions of the picture in the tool's frame, whitened."""
    return FromTool(CameraConvolutions(Whitening()))


def tool_pixels() -> FromTool:
    """The picture in the tool's frame itself, small and whitened."""
    return FromTool(Pixels(Whitening(), side=12))
