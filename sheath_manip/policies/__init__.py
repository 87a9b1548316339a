"""Policies and their embeddings, by name."""

from collections.abc import Callable
from inspect import signature
from typing import Any

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Embedding, TrainablePolicy
from sheath_manip.registry import Registry
from sheath_manip.types import TaskSpec

_HERE = "sheath_manip.policies"
_RECIPES = f"{_HERE}.recipes"

POLICIES: Registry[Callable[..., TrainablePolicy]] = Registry(
    "policy",
    "sheath.policies",
    {
        "cnn": f"{_HERE}.cnn:ConvPolicy",
        "plain-cnn": f"{_RECIPES}:plain_cnn",
        "paper-cnn": f"{_RECIPES}:paper_cnn",
        "spatial-cnn": f"{_HERE}.spatial_cnn:SpatialPolicy",
        "egocentric-cnn": f"{_HERE}.egocentric:EgocentricPolicy",
        "hog-svm": f"{_HERE}.hog_svm:HogSvm",
        "linear-svm": f"{_HERE}.linear_svm:LinearSvm",
        "linear-svm-paper": f"{_RECIPES}:linear_svm_paper",
        "smile": f"{_HERE}.smile:SmileMixture",
        "act": f"{_HERE}.act:ActPolicy",
        "mlp": f"{_HERE}.mlp:MlpPolicy",
    },
)
"""Called with the task's spec, `seed` and further hyperparameters by name."""

_CONVOLUTIONAL = f"{_HERE}.convolutional_embeddings"

IMAGE_EMBEDDINGS = {
    "two-scale-contrasts": f"{_RECIPES}:two_scale_contrasts",
    "foveal-contrasts": f"{_RECIPES}:foveal_contrasts",
    "convolutions-and-pixels": f"{_RECIPES}:convolutions_and_pixels",
    "two-scale-convolutions": f"{_RECIPES}:two_scale_convolutions",
    "foveal-convolutions": f"{_RECIPES}:foveal_convolutions",
    "foveal-convolutions-whitened": f"{_RECIPES}:foveal_convolutions_whitened",
    "pooled-convolutions": f"{_CONVOLUTIONAL}:PooledConvolutions",
    "pooled-convolutions-whitened": f"{_RECIPES}:pooled_convolutions_whitened",
    "random-convolutions": f"{_CONVOLUTIONAL}:RandomConvolutions",
    "penultimate": f"{_CONVOLUTIONAL}:Penultimate",
    "pixels": f"{_HERE}.pixels:Pixels",
    "pixels-whitened": f"{_RECIPES}:pixels_whitened",
}
SPATIAL_EMBEDDINGS = {
    "image-points": f"{_RECIPES}:image_points",
    "image-points-whitened": f"{_RECIPES}:image_points_whitened",
    "camera-convolutions": f"{_RECIPES}:camera_convolutions",
    "camera-convolutions-whitened": f"{_RECIPES}:camera_convolutions_whitened",
    "wrist-convolutions": f"{_RECIPES}:wrist_convolutions",
    "pixels-and-features": f"{_RECIPES}:pixels_and_features",
}
"""of `spatial-cnn`, which looks through several cameras and at features"""
TOOL_EMBEDDINGS = {
    "tool-points": f"{_RECIPES}:tool_points",
    "tool-points-whitened": f"{_RECIPES}:tool_points_whitened",
    "tool-convolutions": f"{_RECIPES}:tool_convolutions",
    "tool-convolutions-whitened": f"{_RECIPES}:tool_convolutions_whitened",
    "tool-pixels": f"{_RECIPES}:tool_pixels",
}
"""of `egocentric-cnn`"""
FEATURE_EMBEDDINGS = {
    "features": f"{_HERE}.features:Features",
    "weighted-features": f"{_HERE}.weighted_features:WeightedFeatures",
}
"""of features that are bits, as they are"""
MEASURED_EMBEDDINGS = {
    "scaled-features": f"{_RECIPES}:scaled_features",
    "mlp-hidden": f"{_RECIPES}:mlp_hidden",
}
"""of features that are measured, each in a unit of its own; the last one is for the policy `mlp`"""
LATENT_EMBEDDINGS = {
    "latent": f"{_HERE}.latent:LatentEmbedding",
    "latent-whitened": f"{_RECIPES}:latent_whitened",
}
"""of policies from elsewhere, which give a layer of theirs along"""
ENCODER_EMBEDDINGS = {"frozen-encoder": f"{_HERE}.frozen_encoder:FrozenEncoder"}
"""of cameras, in the eyes of a network that somebody else has trained; an extra brings it"""
_TABLES = (
    IMAGE_EMBEDDINGS,
    SPATIAL_EMBEDDINGS,
    TOOL_EMBEDDINGS,
    FEATURE_EMBEDDINGS,
    MEASURED_EMBEDDINGS,
    LATENT_EMBEDDINGS,
    ENCODER_EMBEDDINGS,
)
EMBEDDINGS: Registry[Callable[..., Embedding]] = Registry(
    "embedding",
    "sheath.embeddings",
    {name: target for table in _TABLES for name, target in table.items()},
)

DEFAULT_EMBEDDING = "two-scale-contrasts"


def make_policy(
    name: str, spec: TaskSpec, seed: int = 0, **hyperparameters: Any
) -> TrainablePolicy:
    """A fresh policy of the table; UnknownNameError for a name that is not in it."""
    return POLICIES[name](spec, seed=seed, **hyperparameters)


def make_embedding(name: str = DEFAULT_EMBEDDING) -> Embedding:
    """A fresh embedding of the table, such as `pixels`, or of some cameras: `pixels:front,wrist`.

    UnknownNameError for a name that is not in the table, ParameterError for cameras of an embedding
    that does not look through them by name.
    """
    base, cameras = split_name(name)
    make = EMBEDDINGS[base]
    if not cameras:
        return make()
    if "cameras" not in signature(make).parameters:
        raise ParameterError(
            f"embedding {base!r} takes no cameras, as {name!r} has it; wanted {base!r} alone, or "
            f"one that does, such as 'pixels:{','.join(cameras)}': --gate.embedding"
        )
    return make(cameras=cameras)


def split_name(name: str) -> tuple[str, tuple[str, ...]]:
    """Return an embedding's name in the table, and the cameras that stand behind its colon.

    ParameterError where none stands behind a colon.
    """
    base, colon, cameras = name.partition(":")
    if colon and not all(cameras.split(",")):
        raise ParameterError(
            f"embedding {name!r} lacks the name of a camera; wanted {base!r}, or cameras behind "
            f"it like '{base}:front,wrist'"
        )
    return base, tuple(cameras.split(",")) if colon else ()


def embeddings_like(name: str) -> list[str]:
    """Return the embeddings of the house that look at the same part of the observation.

    For an embedding from outside, the embedding itself is returned.
    """
    base, _ = split_name(name)
    return next((list(table) for table in _TABLES if base in table), [name])
