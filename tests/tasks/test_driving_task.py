"""The driving task's episodes: what repeats one to the bit, what ends it, how laps are counted."""

import numpy as np
import pytest

from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.task import CONTROL_TIMESTEP_S, STEERING_RAD, Scenario
from sheath_manip.types import Outcome
from tests.tasks.driven_road import (
    AHEAD,
    LEFT,
    RIGHT,
    STEP_M,
    Road,
    assert_same,
    empty,
    road,
    small,
    wiggle,
)

__all__ = ["empty", "road", "small"]


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
