"""The driving task by itself; most tests look at a tiny picture, since they do not look at it."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from sheath_manip.gates import AlwaysExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.entry import DRIVING
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.task import (
    CONTROL_TIMESTEP_S,
    SPEED_M_S,
    STEERING_RAD,
    DrivingTask,
    Scenario,
)
from sheath_manip.types import EpisodeInfo, Observation, Outcome, Purpose, Transition

LEFT, AHEAD, RIGHT = (np.array([turn], np.float32) for turn in (STEERING_RAD, 0, -STEERING_RAD))
STEP_M = SPEED_M_S * CONTROL_TIMESTEP_S


class Road:
    """An environment with its task, under names of their own types."""

    def __init__(self, scenario: Scenario) -> None:
        self.task = DrivingTask(scenario)
        self.environment = ComposerEnvironment(self.task)

    def put(self, s_m: float, lateral_m: float, turned_rad: float = 0.0) -> None:
        """Put the car onto the road in an episode that has begun, the others far off."""
        away = np.full(self.task.scenario.cars, -500.0)
        self.environment.reset(0)
        self.task.set_traffic(self.environment.physics, np.stack([np.zeros_like(away), away], 1))
        pose = self.task.track.pose(np.array(s_m), np.array(lateral_m))
        self.task.place(self.environment.physics, pose + np.array([0, 0, turned_rad]))
        self.environment.physics.forward()

    def drive(self, actions: Sequence[np.ndarray]) -> list[Transition]:
        """Up to the end of the episode."""
        transitions = []
        for action in actions:
            transitions.append(self.environment.step(action))
            if transitions[-1].terminated or transitions[-1].truncated:
                break
        return transitions


def made(scenario: Scenario) -> Iterator[Road]:
    road = Road(scenario)
    yield road
    road.environment.close()


@pytest.fixture(scope="module")
def road() -> Iterator[Road]:
    """With the pictures of the task's default."""
    yield from made(Scenario())


@pytest.fixture(scope="module")
def small() -> Iterator[Road]:
    """A few cars and a tiny picture."""
    yield from made(Scenario(cars=3, render_px=16, pyramid_levels=1))


@pytest.fixture(scope="module")
def empty() -> Iterator[Road]:
    """No other car, three laps."""
    yield from made(Scenario(laps=3.0, cars=0, render_px=16, pyramid_levels=1))


def assert_same(first: Observation, second: Observation) -> None:
    np.testing.assert_array_equal(first.images["overhead"], second.images["overhead"])
    np.testing.assert_array_equal(first.features, second.features)
    assert first.time_s == second.time_s


def wiggle(count: int) -> list[np.ndarray]:
    rng = np.random.default_rng(1)
    turns = rng.permutation([*[1, -1] * (count // 4), *[0] * (count - count // 4 * 2)])
    return [np.array([turn * STEERING_RAD], np.float32) for turn in turns]


def test_the_same_seed_and_actions_give_the_same_episode_to_the_bit(road):
    actions = wiggle(12)
    first = [road.environment.reset(11), *(t.observation for t in road.drive(actions))]
    road.environment.reset(12)
    road.drive(actions)
    other = Road(Scenario())
    for again in (road, other):
        second = [again.environment.reset(11), *(t.observation for t in again.drive(actions))]
        assert len(first) == len(second)
        for one, two in zip(first, second, strict=True):
            assert_same(one, two)
    np.testing.assert_array_equal(road.environment.state(), other.environment.state())
    other.environment.close()


@pytest.mark.parametrize("start", [0, 1, 7])
def test_restored_it_continues_to_the_bit(road, start):
    environment, actions = road.environment, wiggle(12)
    environment.reset(11)
    states, transitions = [environment.state()], []
    for action in actions:
        transitions.append(environment.step(action))
        states.append(environment.state())
    environment.reset(11)
    seen = environment.restore(states[start])
    np.testing.assert_array_equal(environment.state(), states[start])
    if start:
        np.testing.assert_array_equal(seen.features, transitions[start - 1].observation.features)
        assert seen.time_s == transitions[start - 1].observation.time_s
    for index in range(start, len(actions)):
        transition = environment.step(actions[index])
        assert_same(transition.observation, transitions[index].observation)
        np.testing.assert_array_equal(environment.state(), states[index + 1])


def test_restored_it_looks_as_it_did(road):
    road.environment.reset(11)
    seen = road.drive(wiggle(8))[-1].observation
    assert_same(road.environment.restore(road.environment.state()), seen)


def test_restored_after_its_end_it_goes_on(small):
    small.put(20.0, 0.0)
    state = small.environment.state()
    first = small.drive([RIGHT] * 20)
    assert first[-1].terminated
    small.environment.restore(state)
    assert small.environment.outcome() is Outcome.TIME_LIMIT
    second = small.drive([RIGHT] * 20)
    assert len(second) == len(first)
    assert_same(first[-1].observation, second[-1].observation)


def test_a_contact_is_a_failure(small):
    small.put(0.0, 0.0)
    start = np.array([[7.0, 0.0], [0.0, -500.0], [10.0, -500.0]])
    small.task.set_traffic(small.environment.physics, start)
    transitions = small.drive([AHEAD] * 40)
    last = transitions[-1]
    # 7 m ahead and 6 m/s slower; 2 m of it are the cars' own length.
    assert len(transitions) == pytest.approx(5 / 6 / CONTROL_TIMESTEP_S, abs=1.5)
    assert (last.terminated, last.truncated, last.reward) == (True, False, -1.0)
    assert [t.reward for t in transitions[:-1]] == [0.0] * (len(transitions) - 1)
    assert small.environment.outcome() is Outcome.FAILURE
    _, lateral, _ = small.task.track.coordinates(*last.observation.features[:2])
    assert abs(lateral) < 0.1


def test_passing_beside_a_car_is_no_contact(small):
    small.put(0.0, 1.5)
    start = np.array([[6.0, -1.5], [0.0, -500.0], [10.0, -500.0]])
    small.task.set_traffic(small.environment.physics, start)
    transitions = small.drive([AHEAD] * 12)
    assert not any(transition.terminated for transition in transitions)


@pytest.mark.parametrize(("lateral", "turned"), [(4.0, np.pi / 4), (-4.0, -np.pi / 4)])
def test_leaving_the_road_is_a_failure(small, lateral, turned):
    small.put(0.0, lateral, turned)
    last = small.drive([AHEAD] * 10)[-1]
    assert (last.terminated, last.truncated, last.reward) == (True, False, -1.0)
    assert small.environment.outcome() is Outcome.FAILURE
    _, where, _ = small.task.track.coordinates(*last.observation.features[:2])
    assert small.task.track.road_half_width < abs(where) < small.task.track.road_half_width + STEP_M


def test_a_steering_action_turns_and_the_step_moves(small):
    small.put(0.0, 0.0)
    x, y, heading = small.task.pose(small.environment.physics)
    pose = small.environment.step(LEFT).observation.features
    assert pose[2] == pytest.approx(heading + STEERING_RAD, abs=1e-6)
    expected = (x + STEP_M * np.cos(STEERING_RAD), y + STEP_M * np.sin(STEERING_RAD))
    assert tuple(pose[:2]) == pytest.approx(expected, abs=1e-5)


def test_laps_are_counted(empty):
    environment, expert = empty.environment, DrivingExpert(empty.environment)
    environment.reset(5)
    laps, rewards, terminated = [0.0], [], False
    observation = environment.observe()
    while not terminated:
        transition = environment.step(expert.act(observation))
        observation, terminated = transition.observation, transition.terminated
        laps.append(environment.metrics()["laps"])
        rewards.append(transition.reward)
    assert environment.outcome() is Outcome.SUCCESS
    assert not any(rewards)
    assert laps[-1] == 3.0
    steps = np.diff(laps[:-1]) * empty.task.track.lap_length
    assert (steps > 0.5 * STEP_M).all()
    assert len(laps) == pytest.approx(3 * empty.task.track.lap_length / STEP_M, rel=0.03)


def test_the_wrong_way_counts_nothing_and_must_be_driven_back(empty):
    empty.put(10.0, 0.0, np.pi)
    empty.drive([AHEAD] * 5)
    assert empty.environment.metrics() == {"laps": 0.0}
    assert empty.task.memory()[1] == pytest.approx(-5 * STEP_M, rel=1e-3)


def test_crossing_the_line_is_no_lap(empty):
    empty.put(empty.task.track.lap_length - 2.5, 0.0)
    empty.drive([AHEAD] * 5)
    driven = empty.environment.metrics()["laps"] * empty.task.track.lap_length
    assert driven == pytest.approx(5 * STEP_M, rel=1e-3)


def test_the_time_limit_is_a_truncation(small):
    # 24 steps of 15 degrees are a circle of 3.8 m radius, which fits on the road.
    small.put(0.0, -3.8)
    limit = small.environment.spec.max_steps
    transitions = small.drive([LEFT] * (limit + 5))
    assert len(transitions) == limit
    assert (transitions[-1].terminated, transitions[-1].truncated) == (False, True)
    assert not any(t.truncated for t in transitions[:-1])
    assert small.environment.outcome() is Outcome.TIME_LIMIT
    assert small.task.get_discount(None) == 1.0
    assert small.environment.metrics()["laps"] < 0.1


def test_an_end_of_its_own_has_discount_0(small):
    small.put(0.0, 4.0, np.pi / 4)
    small.drive([AHEAD] * 10)
    assert small.task.get_discount(None) == 0.0


def traffic_of(road: Road, seed: int) -> np.ndarray:
    """(c, 2) track coordinates of the other cars at the start, s from one's own."""
    seen = road.environment.reset(seed)
    track = road.task.track
    own, _, _ = track.coordinates(seen.features[0], seen.features[1])
    poses = road.task.traffic_poses(np.array(0.0))
    s, lateral, _ = track.coordinates(poses[:, 0], poses[:, 1])
    return np.stack([np.mod(s - own, track.lap_length), lateral], 1)


def test_traffic_and_start_differ_by_seed_and_leave_room(road):
    scenes = {seed: traffic_of(road, seed) for seed in range(40)}
    starts = {seed: road.environment.reset(seed).features for seed in range(3)}
    assert not np.allclose(scenes[0], scenes[1])
    assert not np.allclose(starts[0], starts[1])
    for traffic in scenes.values():
        s = np.sort(traffic[:, 0])
        assert s[0] > 10
        assert s[-1] < road.task.track.lap_length - 10
        # Nose to nose; 2 m of it are a car.
        assert np.diff(s).min() > 4.9
        assert np.abs(traffic[:, 1]).max() < road.task.track.road_half_width - 0.5


def test_the_traffic_keeps_its_distances(road):
    road.environment.reset(4)
    track = road.task.track
    s, lateral, _ = track.coordinates(
        *np.moveaxis(road.task.traffic_poses(np.array([0, 9.0])), -1, 0)[:2]
    )
    moved = np.mod(s[1] - s[0], track.lap_length)
    np.testing.assert_allclose(moved, moved[0], atol=1e-6)
    np.testing.assert_allclose(lateral[0], lateral[1], atol=1e-6)


def test_the_papers_camera_shows_the_same(road):
    paper = DRIVING.make("paper-camera")
    for seed in (3, 8):
        fine = paper.reset(seed).images["overhead"]
        default = road.environment.reset(seed).images["overhead"]
        assert fine.shape == default.shape == (125, 125, 3)
        assert np.abs(fine.astype(float) - default).mean() < 2.0
    paper.close()


def test_the_camera_turns_with_the_car(road):
    views = []
    for s in (0.0, road.task.track.half_length - road.task.track.corner_radius + 1.0):
        road.put(s, 0.0)
        views.append(road.environment.observe().images["overhead"].astype(float))
    straight, corner = views
    # The tail of the red car, a little below the middle; straight ahead of it lies tarmac.
    red, green, blue = straight[66, 62]
    assert red > 2 * max(green, blue)
    ahead = straight[10, 50:75].mean(0)
    assert np.ptp(ahead) < 40
    # Where the road bends to the left, there is grass ahead.
    far_ahead = corner[4, 66:90].mean(0)
    assert np.argmax(far_ahead) == 1
    assert far_ahead[1] > far_ahead[2] + 20


def test_place_and_set_traffic(small):
    small.environment.reset(0)
    physics = small.environment.physics
    small.task.place(physics, np.array([3.0, -15.0, 0.2]))
    np.testing.assert_array_equal(small.task.pose(physics), [3.0, -15.0, 0.2])
    start = np.array([[10.0, 1.0], [50.0, -2.0], [90.0, 0.0]])
    small.task.set_traffic(physics, start)
    expected = small.task.track.pose(start[:, 0], start[:, 1])
    np.testing.assert_allclose(small.task.traffic_poses(np.array(0.0)), expected)
    physics.forward()
    shown = small.environment.pose().bodies
    for pose in expected:
        assert np.hypot(*(shown[:, :2] - pose[:2]).T).min() < 1e-9


def test_a_scene_without_other_cars_can_be_driven(empty):
    info = EpisodeInfo("driving", 2, Purpose.DEMONSTRATION, 10.0)
    empty.task.scenario = Scenario(laps=0.2, cars=0)
    try:
        episode = rollout(
            empty.environment,
            info,
            AlwaysExpert(),
            rng=np.random.default_rng(0),
            expert=DrivingExpert(empty.environment),
        )
    finally:
        empty.task.scenario = Scenario(laps=3.0, cars=0)
    assert episode.outcome is Outcome.SUCCESS
