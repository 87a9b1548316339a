"""Demonstrations with a disturbed hand and clean labels."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.rollout.action_noise import DisturbedExpert
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Actor, Episode, EpisodeInfo, Observation, Purpose
from tests.reach import ACTION
from tests.toy import Corridor, MiddleKeeper

INFO = EpisodeInfo("corridor", 5, Purpose.DEMONSTRATION, 50.0)


class Still:
    """An expert that wants to stay where it is."""

    def reset(self) -> None:
        pass

    def act(self, observation: Observation) -> np.ndarray:
        del observation
        return np.array([0.1, 0.0], np.float32)


def demonstration(seed: int = 0, noise: float = 0.3) -> Episode:
    environment = Corridor(steps=24)
    expert = CachedExpert(MiddleKeeper(environment))
    disturbed = DisturbedExpert(expert, environment.spec.action, noise)
    gate, rng = AlwaysPolicy(query=True), np.random.default_rng(seed)
    return rollout(environment, INFO, gate, rng=rng, policy=disturbed, expert=expert)


def executed(episode: Episode) -> list[float]:
    return [float(step.executed[0]) for step in episode.steps]


def test_what_is_executed_is_disturbed_and_what_is_labelled_is_not():
    episode = demonstration()
    environment = Corridor(steps=24)
    environment.reset(INFO.seed)
    for step in episode.steps:
        environment.restore(step.state)
        assert step.labelled is not None
        expert = MiddleKeeper(environment).act(step.observation)
        np.testing.assert_array_equal(step.labelled, expert)
        assert step.decision.actor is Actor.POLICY
    assert any((step.executed != step.labelled).any() for step in episode.steps)


def test_the_episode_s_generator_alone_decides_the_pushes():
    assert executed(demonstration(1)) == executed(demonstration(1))
    assert executed(demonstration(1)) != executed(demonstration(2))


def test_without_noise_it_is_the_expert():
    for step in demonstration(noise=0.0).steps:
        np.testing.assert_array_equal(step.executed, step.labelled)


def test_pushes_have_the_asked_size_last_a_while_and_stay_within_the_bounds():
    disturbed = DisturbedExpert(Still(), ACTION, 0.2)
    disturbed.reset(np.random.default_rng(0))
    nothing = Observation({}, np.zeros(2, np.float32), 0.0)
    disturbed.follow(nothing)
    actions = np.stack([disturbed.propose(nothing.alone).now[0] for _ in range(5000)])
    for one in actions:
        ACTION.validated(one)
    pushes = actions[:, 1] / 0.1
    assert pushes.std() == pytest.approx(0.2, rel=0.1)
    assert abs(pushes.mean()) < 0.05
    assert np.corrcoef(pushes[1:], pushes[:-1])[0, 1] == pytest.approx(np.exp(-1 / 5), abs=0.03)


def test_a_negative_noise_is_refused():
    with pytest.raises(ParameterError, match=r"noise is -0\.1; wanted"):
        DisturbedExpert(Still(), ACTION, -0.1)
