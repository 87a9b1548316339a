"""What a LeRobot policy takes is found in an observation by name, or one line says what lacks."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.adapters.lerobot_inputs import Inputs
from sheath_manip.exceptions import CheckpointError, ParameterError
from sheath_manip.types import Observations
from tests.adapters.lerobot_stand_in import IMAGES, SPEC, VECTORS, config, observations

INPUTS = Inputs(VECTORS, IMAGES, feature_names=SPEC.feature_names)


def test_the_config_says_what_goes_in():
    backwards = dict(reversed(config()["input_features"].items()))
    found = Inputs.described(config(input_features=backwards))
    assert (found.vectors, found.images) == (VECTORS, IMAGES)
    assert list(found.vectors) == list(VECTORS)
    INPUTS.check(SPEC)


def test_vectors_follow_each_other_and_images_are_scaled():
    seen = observations(3)
    batch = INPUTS.batch(seen)
    assert list(batch) == [*VECTORS, *IMAGES]
    assert np.array_equal(batch["observation.state"], seen.features[:, :2])
    assert np.array_equal(batch["observation.environment_state"], seen.features[:, 2:])
    front = batch["observation.images.front"]
    assert front.shape == (3, 3, 8, 6)
    # To the bit what LeRobot makes of an image: divided, not multiplied by the inverse.
    wanted = seen.images["front"].astype(np.float32) / 255
    assert np.array_equal(front, wanted.transpose(0, 3, 1, 2))


def test_a_vector_as_wide_as_the_features_is_all_of_them():
    for vectors in ({"observation.state": 5}, dict.fromkeys(VECTORS, 5)):
        seen = observations(2)
        for vector in Inputs(vectors, {}).batch(seen).values():
            assert np.array_equal(vector, seen.features)


def test_features_are_taken_by_name_in_the_named_order():
    inputs = replace(INPUTS, vectors={"observation.state": 2}, images={})
    inputs = replace(inputs, features={"observation.state": ("d", "a")})
    seen = observations(2)
    assert np.array_equal(inputs.batch(seen)["observation.state"], seen.features[:, [3, 0]])


def test_cameras_are_told_by_name_and_a_single_image_is_the_only_camera():
    seen = observations(1)
    named = Inputs({}, {"observation.images.top": (4, 4)}, {"observation.images.top": "wrist"})
    alone = Inputs({}, {"observation.image": (4, 4)})
    shown = Observations({"wrist": seen.images["wrist"]}, seen.features)
    (top,) = named.batch(seen).values()
    (only,) = alone.batch(shown).values()
    assert np.array_equal(top, only)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        (
            {"vectors": {"observation.state": 7}},
            r"state of 7 numbers, the observation has 5 .*a, b",
        ),
        ({"images": {"observation.images.top": (4, 4)}}, r"camera 'top', .* has front, wrist"),
        ({"images": {"observation.images.front": (9, 6)}}, r"9 x 6 px .* gives 8 x 6 px"),
        ({"features": {"observation.state": ("a", "z")}}, r"2 numbers, unknown: z"),
        ({"features": {"observation.state": ("a",)}}, r"2 numbers, 1 are named"),
        ({"features": {"observation.state": ("a",)}, "feature_names": None}, "wanted the task's"),
    ],
)
def test_what_lacks_is_said_in_one_line(changes, says):
    inputs = replace(INPUTS, **changes)
    with pytest.raises(ParameterError, match=says) as error:
        inputs.check(SPEC)
    assert "\n" not in str(error.value)
    with pytest.raises(ParameterError, match=says):
        replace(inputs).batch(observations(1))


@pytest.mark.parametrize(
    ("inputs", "says"),
    [
        (None, "does not say what it takes"),
        ({"observation.state": {"type": "STATE"}}, "does not say what it takes"),
        ({"observation.images.a": {"type": "VISUAL", "shape": [3]}}, "does not say what it takes"),
        ({"observation.language": {"type": "LANGUAGE", "shape": [8]}}, "the kind LANGUAGE"),
    ],
)
def test_a_config_that_does_not_say_it(inputs, says):
    with pytest.raises(CheckpointError, match=says):
        Inputs.described(config(input_features=inputs))
