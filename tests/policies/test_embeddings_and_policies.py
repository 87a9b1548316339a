"""Every embedding with policies that it goes with and others, and cameras of all names."""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.beforehand import require_makeable
from sheath_manip.policies import (
    EMBEDDINGS,
    IMAGE_EMBEDDINGS,
    TOOL_EMBEDDINGS,
    embeddings_like,
    make_embedding,
    make_policy,
)
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples
from tests import blobs, buttons, line, reach, servo
from tests.looks import fitted_embedding, vectors_of

ANY = {"features", "scaled-features"}
"""embeddings that do for any policy of any task with features"""
PIXELS = {"pixels", "pixels-whitened", "pixels-and-features"}
THROUGH_CAMERAS = {
    "image-points",
    "image-points-whitened",
    "camera-convolutions",
    "camera-convolutions-whitened",
}
QUICK = {"steps": 2}


@dataclass(frozen=True)
class World:
    """A task, a policy of the house on it, and the embeddings that go with both."""

    policy: str
    spec: TaskSpec
    states: Samples
    settings: dict
    works: set[str]

    @property
    def config(self) -> PolicyConfig:
        return PolicyConfig(self.policy, self.settings)


def renamed(samples: Samples, names: dict[str, str]) -> Samples:
    images = {names[camera]: images for camera, images in samples.images.items() if camera in names}
    return replace(samples, images=images)


def with_cameras(policy: str, names: dict[str, str], works: set[str]) -> World:
    cameras = {new: reach.SPEC.cameras[old] for old, new in names.items()}
    settings = {**(reach.ACT_SETTINGS if policy == "act" else reach.SETTINGS), **QUICK}
    return World(
        policy,
        replace(reach.SPEC, cameras=cameras),
        renamed(reach.training().take(np.arange(40)), names),
        settings,
        works,
    )


OF_CAMERAS = ANY | PIXELS | THROUGH_CAMERAS
LATENT = {"latent", "latent-whitened"}
"""of policies that give one"""
BOTH = {"above": "above", "wrist": "wrist"}
WORLDS = {
    "no camera, mlp": World(
        "mlp",
        servo.SPEC,
        servo.training().take(np.arange(40)),
        QUICK,
        ANY | LATENT | {"mlp-hidden", "penultimate"},
    ),
    "no camera, linear-svm": World(
        "linear-svm",
        buttons.SPEC,
        buttons.training().take(np.arange(40)),
        {"penalty": 0.1},
        ANY | {"weighted-features"},
    ),
    "one camera of another name, cnn": World(
        "cnn",
        blobs.SPEC,
        blobs.training().take(np.arange(40)),
        {"epochs": 1},
        ANY | PIXELS | set(IMAGE_EMBEDDINGS) | {"mlp-hidden"},
    ),
    "two cameras, act": with_cameras("act", BOTH, OF_CAMERAS | {"wrist-convolutions"}),
    "two cameras of other names, spatial-cnn": with_cameras(
        "spatial-cnn", {"above": "agentview_image", "wrist": "images.hand"}, OF_CAMERAS
    ),
    "one camera of another name, act": with_cameras(
        "act", {"wrist": "images.0"}, OF_CAMERAS | LATENT
    ),
    "a tool's view, egocentric-cnn": World(
        "egocentric-cnn",
        line.SPEC,
        line.training().take(np.arange(40)),
        {"spatial_settings": {**line.SETTINGS["spatial_settings"], **QUICK}},
        ANY | PIXELS | set(TOOL_EMBEDDINGS),
    ),
}


@cache
def fitted(world: str) -> TrainablePolicy:
    each = WORLDS[world]
    return make_policy(each.policy, each.spec, **each.settings).fit(each.states)


@pytest.mark.parametrize("world", WORLDS)
def test_an_embedding_works_or_says_in_one_line_what_would(world):
    each, works, said = WORLDS[world], set[str](), list[str]()
    # `frozen-encoder` wants a package of its own, in whose place tests/small_encoder.py stands.
    for name in EMBEDDINGS.keys() - {"frozen-encoder"}:
        gate = GateConfig(signal="support", embedding=name)
        try:
            require_makeable(each.spec, each.config, gate)
            embedding = fitted_embedding(make_embedding(name), fitted(world), each.states)
            assert np.isfinite(vectors_of(embedding, fitted(world), each.states)).all()
            works.add(name)
        except ParameterError as error:
            said.append(str(error))
    assert works == each.works
    for line_ in said:
        assert "\n" not in line_
        assert "--gate.embedding" in line_ or "it gives" in line_


def test_cameras_are_named_behind_a_colon_in_the_order_that_is_wanted():
    world = "two cameras of other names, spatial-cnn"
    states = WORLDS[world].states

    def vectors(name: str) -> np.ndarray:
        embedding = fitted_embedding(make_embedding(name), fitted(world), states)
        return vectors_of(embedding, fitted(world), states)

    for name in ("camera-convolutions", "image-points", "pixels"):
        alone, other = vectors(f"{name}:images.hand"), vectors(f"{name}:agentview_image")
        both = vectors(f"{name}:agentview_image,images.hand")
        assert alone.shape == other.shape
        assert (alone != other).any()
        np.testing.assert_array_equal(both, vectors(name))


def test_the_wrists_convolutions_are_few_directions_of_that_camera_alone():
    world = "two cameras, act"
    states, policy = WORLDS[world].states, fitted(world)
    wrist = fitted_embedding(make_embedding("wrist-convolutions"), policy, states)
    vectors = vectors_of(wrist, policy, states)
    assert vectors.shape[1] == 48 + len(WORLDS[world].spec.feature_names)

    def without(camera: str) -> np.ndarray:
        black = np.zeros_like(states.images[camera])
        images = {**states.images, camera: black}
        return vectors_of(wrist, policy, replace(states, images=images))

    np.testing.assert_array_equal(without("above"), vectors)
    assert (without("wrist") != vectors).any()


@pytest.mark.parametrize("name", ["pixels", "camera-convolutions"])
def test_a_camera_that_is_not_there_is_told_before_anything_is_fitted(name):
    each = WORLDS["two cameras, act"]
    gate = GateConfig(signal="support", embedding=f"{name}:elbow")
    with pytest.raises(ParameterError, match=r"no camera 'elbow' .*, there is above,wrist;"):
        require_makeable(each.spec, each.config, gate)


@pytest.mark.parametrize("name", ["penultimate:top", "features:top", "tool-points:top"])
def test_an_embedding_without_cameras_by_name_says_so(name):
    with pytest.raises(ParameterError, match=r"takes no cameras, .* such as 'pixels:top'"):
        make_embedding(name)


@pytest.mark.parametrize("name", ["pixels:", "pixels:top,", "pixels:,top"])
def test_a_colon_wants_a_camera_behind_it(name):
    with pytest.raises(ParameterError, match="lacks the name of a camera"):
        make_embedding(name)


def test_with_cameras_it_looks_like_itself():
    assert embeddings_like("camera-convolutions:wrist") == embeddings_like("camera-convolutions")
