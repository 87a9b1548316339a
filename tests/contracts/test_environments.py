"""What every task of the table must do."""

import pickle
from collections.abc import Iterator

import numpy as np
import pytest

from sheath_manip.exceptions import ActionError, UnknownNameError
from sheath_manip.protocols import Environment
from sheath_manip.tasks.table import STUDIES, TASKS
from sheath_manip.types import Action, Observation, Outcome

SHAPES = {"box", "sphere", "capsule", "cylinder", "ellipsoid", "mesh", "picture"}


@pytest.fixture(params=sorted(TASKS), scope="module")
def name(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def environment(name) -> Iterator[Environment]:
    environment = TASKS[name].make()
    yield environment
    environment.close()


def middle(environment: Environment) -> Action:
    """An action that every task admits."""
    spec = environment.spec.action
    if spec.choices is not None:
        return spec.choices[len(spec.choices) // 2]
    return ((spec.minimum + spec.maximum) / 2).astype(np.float32)


def assert_fits(observation: Observation, environment: Environment) -> None:
    spec = environment.spec
    assert list(observation.images) == list(spec.cameras)
    for camera, (height, width) in spec.cameras.items():
        image = observation.images[camera]
        assert image.shape == (height, width, 3)
        assert image.dtype == np.uint8
        # Something is to be seen.
        assert image.std() > 1
    assert observation.features.shape == (len(spec.feature_names),)
    assert observation.features.dtype == np.float32
    assert np.isfinite(observation.features).all()
    assert isinstance(observation.time_s, float)


def assert_equal(first: Observation, second: Observation) -> None:
    assert_same_values(first, second)
    for camera, image in first.images.items():
        np.testing.assert_array_equal(image, second.images[camera])


def assert_same_values(first: Observation, second: Observation) -> None:
    np.testing.assert_array_equal(first.features, second.features)
    assert first.time_s == second.time_s


def test_the_entry_is_complete_and_can_be_pickled(name):
    entry = TASKS[name]
    assert entry.name == name
    assert entry.summary
    assert {"default", "final"} <= set(entry.variants)
    assert pickle.loads(pickle.dumps(entry)).name == name
    with pytest.raises(UnknownNameError, match="default"):
        entry.make("nonesuch")


def test_the_study_is_complete_and_can_be_pickled(name):
    study = STUDIES[name]
    assert study.task is TASKS[name]
    assert {"full", "quick"} <= set(study.plans)
    assert study.plan("quick").units() < study.plan("full").units()
    copy = pickle.loads(pickle.dumps(study))
    assert list(copy.figures) == list(study.figures)
    with pytest.raises(UnknownNameError, match="quick"):
        study.plan("nonesuch")


def test_the_spec_is_consistent(name, environment):
    spec = environment.spec
    assert spec.name == name
    assert spec.control_rate_hz > 0
    assert spec.max_steps > 0
    action = spec.action
    assert action.minimum.shape == action.maximum.shape == (len(action.names),)
    assert action.minimum.dtype == action.maximum.dtype == np.float32
    assert (action.minimum < action.maximum).all()
    if action.choices is not None:
        assert len(action.choices) >= 2
        for choice in action.choices:
            action.validated(choice)
    assert len(set(spec.feature_names)) == len(spec.feature_names)
    assert set(spec.plane or ()) <= set(spec.feature_names)


def test_observations_fit_the_spec(environment):
    observation = environment.reset(1)
    assert_fits(observation, environment)
    assert observation.time_s == 0.0
    assert environment.outcome() is Outcome.TIME_LIMIT
    assert environment.spec.metric in environment.metrics()
    for number in range(1, 4):
        transition = environment.step(middle(environment))
        assert_fits(transition.observation, environment)
        assert type(transition.reward) is float
        assert type(transition.terminated) is type(transition.truncated) is bool
        assert not (transition.terminated and transition.truncated)
        wanted_s = number / environment.spec.control_rate_hz
        assert transition.observation.time_s == pytest.approx(wanted_s)
        assert all(isinstance(value, float) for value in environment.metrics().values())


def test_an_observation_is_not_overwritten_by_the_next(environment):
    observation = environment.reset(1)
    kept = {camera: image.copy() for camera, image in observation.images.items()}
    features = observation.features.copy()
    for _ in range(3):
        environment.step(middle(environment))
    for camera, image in kept.items():
        np.testing.assert_array_equal(observation.images[camera], image)
    np.testing.assert_array_equal(observation.features, features)


def test_the_seed_makes_the_episode(environment):
    def run(seed: int) -> tuple[list[Observation], np.ndarray]:
        seen = [environment.reset(seed)]
        seen += [environment.step(middle(environment)).observation for _ in range(3)]
        return seen, environment.state()

    first, state = run(2**32 - 1)
    other, other_state = run(3)
    again, again_state = run(2**32 - 1)
    for one, two in zip(first, again, strict=True):
        assert_equal(one, two)
    np.testing.assert_array_equal(state, again_state)
    assert not np.array_equal(state, other_state)
    assert not np.array_equal(first[0].features, other[0].features)
    for camera, image in first[0].images.items():
        assert not np.array_equal(image, other[0].images[camera])


@pytest.mark.parametrize("spoil", ["nan", "above", "below", "shape"])
def test_a_bad_action_is_refused_and_changes_nothing(spoil, environment):
    spec = environment.spec.action
    action = {
        "nan": np.full_like(spec.minimum, np.nan),
        "above": spec.maximum + 1,
        "below": spec.minimum - 1,
        "shape": np.zeros(len(spec.minimum) + 1, np.float32),
    }[spoil]
    environment.reset(1)
    environment.step(middle(environment))
    before = environment.state()
    with pytest.raises(ActionError, match=spec.names[0]):
        environment.step(action)
    np.testing.assert_array_equal(environment.state(), before)


def test_a_state_is_restored_to_the_bit(environment):
    environment.reset(5)
    environment.step(middle(environment))
    state = environment.state()
    assert state.ndim == 1
    assert state.dtype == np.float64
    assert np.isfinite(state).all()
    before = [environment.step(middle(environment)) for _ in range(3)]
    end = environment.state()
    metrics = dict(environment.metrics())
    restored = environment.restore(state)
    assert_fits(restored, environment)
    np.testing.assert_array_equal(environment.state(), state)
    assert_same_values(environment.restore(state), restored)
    for transition in before:
        again = environment.step(middle(environment))
        assert_equal(again.observation, transition.observation)
        assert again.reward == transition.reward
    np.testing.assert_array_equal(environment.state(), end)
    assert dict(environment.metrics()) == metrics


def test_ends_by_its_time_limit_at_the_latest_and_starts_again(environment):
    environment.reset(1)
    state = environment.state()
    steps, ended, terminated = 0, False, False
    while not ended:
        transition = environment.step(middle(environment))
        steps += 1
        terminated, ended = transition.terminated, transition.terminated or transition.truncated
    assert steps <= environment.spec.max_steps
    assert terminated or steps == environment.spec.max_steps
    assert (environment.outcome() is Outcome.TIME_LIMIT) == (not terminated)
    # Neither a restored nor a new episode inherits the end.
    environment.restore(state)
    again = environment.step(middle(environment))
    assert not again.terminated
    assert not again.truncated
    assert again.observation.time_s == pytest.approx(1 / environment.spec.control_rate_hz)
    environment.reset(1)
    np.testing.assert_array_equal(environment.state(), state)


def test_viewers_get_shapes_and_poses(environment):
    environment.reset(1)
    scene, pose = environment.scene(), environment.pose()
    poses = pose.bodies
    assert poses.ndim == 2
    assert poses.shape[1] == 7
    assert np.isfinite(poses).all()
    np.testing.assert_allclose(np.linalg.norm(poses[:, 3:], axis=1), 1, atol=1e-9)
    assert scene
    assert pose.contacts_m.shape[1:] == (3,)
    if pose.tool_m is not None:
        assert pose.tool_m.shape == (3,)
        assert np.isfinite(pose.tool_m).all()
    for line in pose.lines:
        assert line.points_m.ndim == 2
        assert line.points_m.shape[1] == 3
        assert np.isfinite(line.points_m).all()
    for surface in pose.surfaces:
        assert surface.vertices_m.shape[1:] == surface.faces.shape[1:] == (3,)
        assert surface.faces.max() < len(surface.vertices_m)
    for geom in scene:
        assert geom.shape in SHAPES
        assert 0 <= geom.body < len(poses)
        assert geom.size.shape == geom.position_in_body.shape == (3,)
        assert len(geom.rgba) == 4
        assert all(0 <= value <= 1 for value in geom.rgba)
        assert np.linalg.norm(geom.wxyz_in_body) == pytest.approx(1)
        assert (geom.vertices is not None) == (geom.faces is not None) == (geom.shape == "mesh")
        if geom.picture is not None:
            assert geom.picture.dtype == np.uint8
            assert geom.picture.shape[2] == 3
    environment.reset(2)
    assert [(g.body, g.shape) for g in environment.scene()] == [(g.body, g.shape) for g in scene]
    assert environment.pose().bodies.shape == poses.shape
    environment.step(middle(environment))
    assert not np.array_equal(environment.pose().bodies, poses)


def test_viewers_see_a_state_as_it_was(environment):
    environment.reset(2)
    states, poses = [], []
    for _ in range(3):
        environment.step(middle(environment))
        states.append(environment.state())
        poses.append(environment.pose())
    for state, pose in zip(reversed(states), reversed(poses), strict=True):
        again = environment.pose_at(state)
        np.testing.assert_allclose(again.bodies, pose.bodies, atol=1e-9)
        assert (again.tool_m is None) == (pose.tool_m is None)
        if again.tool_m is not None:
            np.testing.assert_allclose(again.tool_m, pose.tool_m, atol=1e-9)
        np.testing.assert_array_equal(environment.state(), state)
