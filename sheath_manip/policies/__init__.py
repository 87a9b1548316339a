"""Policies and their embeddings, by name."""

from collections.abc import Callable
from functools import partial
from typing import Any

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.policies.embeddings import (
    FovealConvolutions,
    Penultimate,
    Pixels,
    PooledConvolutions,
)
from sheath_manip.policies.hog_svm import HogSvm
from sheath_manip.policies.scaling import Whitening
from sheath_manip.protocols import Embedding, Policy
from sheath_manip.types import TaskSpec

POLICIES: dict[str, Callable[..., Policy]] = {
    "cnn": ConvPolicy,
    "paper-cnn": partial(ConvPolicy, channels=(16,)),
    "hog-svm": HogSvm,
}
"""Called with the task's spec, `seed` and further hyperparameters by name."""

EMBEDDINGS: dict[str, Callable[[], Embedding]] = {
    "foveal-convolutions": lambda: FovealConvolutions(Whitening()),
    "pooled-convolutions": PooledConvolutions,
    "pooled-convolutions-whitened": lambda: PooledConvolutions(Whitening()),
    "penultimate": Penultimate,
    "pixels": Pixels,
}

DEFAULT_EMBEDDING = "foveal-convolutions"


def make_policy(name: str, spec: TaskSpec, seed: int = 0, **hyperparameters: Any) -> Policy:
    """A fresh policy of the table; UnknownNameError for a name that is not in it."""
    if name not in POLICIES:
        raise UnknownNameError("policy", name, POLICIES)
    return POLICIES[name](spec, seed=seed, **hyperparameters)


def make_embedding(name: str = DEFAULT_EMBEDDING) -> Embedding:
    """A fresh embedding of the table; UnknownNameError for a name that is not in it."""
    if name not in EMBEDDINGS:
        raise UnknownNameError("embedding", name, EMBEDDINGS)
    return EMBEDDINGS[name]()
