"""What every task's expert must do (tests/tasks/test_task_executors.py: it does so again)."""

from collections.abc import Iterator

import numpy as np
import pytest

from sheath_manip.gates import AlwaysExpert
from sheath_manip.protocols import Environment, Expert
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Episode, EpisodeInfo, Outcome, Purpose

SEED = 77


@pytest.fixture(params=sorted(TASKS), scope="module")
def name(request) -> str:
    return request.param


@pytest.fixture(scope="module")
def environment(name) -> Iterator[Environment]:
    environment = TASKS[name].make()
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def expert(name, environment) -> Expert:
    return TASKS[name].expert(environment)


def demonstrated(name: str, environment: Environment, expert: Expert) -> Episode:
    info = EpisodeInfo(name, SEED, Purpose.DEMONSTRATION, environment.spec.control_rate_hz)
    return rollout(environment, info, AlwaysExpert(), rng=np.random.default_rng(0), expert=expert)


@pytest.fixture(scope="module")
def episode(name, environment, expert) -> Episode:
    return demonstrated(name, environment, expert)


def test_succeeds_with_valid_actions(environment, episode):
    assert episode.outcome is Outcome.SUCCESS
    assert (episode.terminated, episode.truncated) == (True, False)
    spec = environment.spec.action
    for step in episode.steps:
        spec.validated(step.requested)
        assert step.executed.dtype == np.float32
        if spec.choices is not None:
            assert (np.abs(spec.choices - step.executed).max(axis=1) < 1e-6).any()


def test_looking_changes_nothing(environment, expert):
    observation = environment.reset(SEED)
    expert.reset()
    before = environment.state()
    first = expert.act(observation)
    np.testing.assert_array_equal(environment.state(), before)
    np.testing.assert_array_equal(expert.act(observation), first)


def test_takes_over_in_the_midst(environment, expert, episode):
    """From any state of an episode it says the same each time, and goes on to succeed."""
    third = max(len(episode) // 3, 1)
    for state in (episode.steps[third].state, episode.steps[2 * third].state):
        environment.reset(episode.info.seed)
        observation = environment.restore(state)
        expert.reset()
        first = expert.act(observation)
        expert.reset()
        np.testing.assert_array_equal(expert.act(observation), first)
        ended = False
        while not ended:
            transition = environment.step(expert.act(observation))
            observation = transition.observation
            ended = transition.terminated or transition.truncated
        assert environment.outcome() is Outcome.SUCCESS
