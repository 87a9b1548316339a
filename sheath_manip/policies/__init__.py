"""Policies and their embeddings, by name."""

from collections.abc import Callable
from functools import partial
from typing import Any

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.policies.contrast_whitening import ContrastWhitening
from sheath_manip.policies.convolutional_embeddings import (
    FovealConvolutions,
    Penultimate,
    PooledConvolutions,
    RandomConvolutions,
    TwoScaleConvolutions,
)
from sheath_manip.policies.egocentric import EgocentricPolicy
from sheath_manip.policies.features import Features, ScaledFeatures
from sheath_manip.policies.hog_svm import HogSvm
from sheath_manip.policies.linear_svm import LinearSvm
from sheath_manip.policies.pixels import Pixels
from sheath_manip.policies.scaling import Whitening
from sheath_manip.policies.side_by_side import SideBySide
from sheath_manip.policies.smile import SmileMixture
from sheath_manip.policies.spatial_cnn import SpatialPolicy
from sheath_manip.policies.spatial_embeddings import CameraConvolutions, ImagePoints
from sheath_manip.policies.tool_view_embedding import FromTool
from sheath_manip.policies.weighted_features import WeightedFeatures
from sheath_manip.protocols import Embedding, TrainablePolicy
from sheath_manip.types import TaskSpec

# For the action alone, without the painting, the lower rate is enough.
_plain_policy = partial(ConvPolicy, learning_rate=1e-3, reconstruction_weight=0.0)

POLICIES: dict[str, Callable[..., TrainablePolicy]] = {
    "cnn": ConvPolicy,
    "plain-cnn": _plain_policy,
    "paper-cnn": partial(_plain_policy, channels=(16,)),
    "spatial-cnn": SpatialPolicy,
    "egocentric-cnn": EgocentricPolicy,
    "hog-svm": HogSvm,
    "linear-svm": LinearSvm,
    # Ross et al. 2011 and the draft.
    "linear-svm-paper": partial(LinearSvm, penalty=0.01),
    "smile": SmileMixture,
}
"""Called with the task's spec, `seed` and further hyperparameters by name."""


def _convolutions_and_pixels() -> SideBySide:
    """What the policy makes of the image, the image itself, and its middle more closely.

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


IMAGE_EMBEDDINGS: dict[str, Callable[[], Embedding]] = {
    "convolutions-and-pixels": _convolutions_and_pixels,
    "two-scale-convolutions": lambda: TwoScaleConvolutions(ContrastWhitening()),
    "foveal-convolutions": lambda: FovealConvolutions(ContrastWhitening()),
    "foveal-convolutions-whitened": lambda: FovealConvolutions(Whitening()),
    "pooled-convolutions": PooledConvolutions,
    "pooled-convolutions-whitened": lambda: PooledConvolutions(Whitening()),
    "random-convolutions": RandomConvolutions,
    "penultimate": Penultimate,
    "pixels": Pixels,
    "pixels-whitened": lambda: Pixels(Whitening()),
}


def _and_features(seen: Embedding) -> SideBySide:
    """What the cameras see, and what the robot feels of itself."""
    return SideBySide({"seen": seen, "felt": ScaledFeatures()}, {"seen": 2.0, "felt": 1.0})


SPATIAL_EMBEDDINGS: dict[str, Callable[[], Embedding]] = {
    "image-points": lambda: _and_features(ImagePoints()),
    "image-points-whitened": lambda: _and_features(ImagePoints(Whitening())),
    "camera-convolutions": lambda: _and_features(CameraConvolutions()),
    "camera-convolutions-whitened": lambda: _and_features(CameraConvolutions(Whitening())),
    "wrist-convolutions": lambda: _and_features(
        CameraConvolutions(Whitening(), cameras=("wrist",))
    ),
    "pixels-and-features": lambda: _and_features(Pixels(Whitening(), side=12)),
}
"""of `spatial-cnn`, which looks through several cameras and at features"""
TOOL_EMBEDDINGS: dict[str, Callable[[], Embedding]] = {
    "tool-points": lambda: FromTool(ImagePoints()),
    "tool-points-whitened": lambda: FromTool(ImagePoints(Whitening())),
    "tool-convolutions": lambda: FromTool(CameraConvolutions()),
    "tool-convolutions-whitened": lambda: FromTool(CameraConvolutions(Whitening())),
    "tool-pixels": lambda: FromTool(Pixels(Whitening(), side=12)),
}
"""of `egocentric-cnn`"""
FEATURE_EMBEDDINGS: dict[str, Callable[[], Embedding]] = {
    "features": Features,
    "weighted-features": WeightedFeatures,
}
EMBEDDINGS = IMAGE_EMBEDDINGS | SPATIAL_EMBEDDINGS | TOOL_EMBEDDINGS | FEATURE_EMBEDDINGS

DEFAULT_EMBEDDING = "convolutions-and-pixels"


def make_policy(
    name: str, spec: TaskSpec, seed: int = 0, **hyperparameters: Any
) -> TrainablePolicy:
    """A fresh policy of the table; UnknownNameError for a name that is not in it."""
    if name not in POLICIES:
        raise UnknownNameError("policy", name, POLICIES)
    return POLICIES[name](spec, seed=seed, **hyperparameters)


def make_embedding(name: str = DEFAULT_EMBEDDING) -> Embedding:
    """A fresh embedding of the table; UnknownNameError for a name that is not in it."""
    if name not in EMBEDDINGS:
        raise UnknownNameError("embedding", name, EMBEDDINGS)
    return EMBEDDINGS[name]()


def embeddings_like(name: str) -> list[str]:
    """All that look at the same part of the observation as the one of that name."""
    tables = (IMAGE_EMBEDDINGS, SPATIAL_EMBEDDINGS, TOOL_EMBEDDINGS, FEATURE_EMBEDDINGS)
    return next(list(table) for table in tables if name in table)
