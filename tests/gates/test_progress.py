"""To be stuck is noticed: nothing moves for longer than it ever does under the expert."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.progress import Progress, ProgressGate
from sheath_manip.gates.support import SupportGate
from sheath_manip.types import Actor, Observation, Proposal, Reason
from tests.judging import always

STEPS = 20
PROPOSED = Proposal(np.zeros((1, 1), np.float32))


def walked(speed: float, pause: int = 0, steps: int = 80) -> np.ndarray:
    """(n, 2) a walk, with a pause in its middle, beside a feature that never moves."""
    moving = np.full(steps, speed)
    moving[steps // 2 : steps // 2 + pause] = 0.0
    return np.stack([np.cumsum(moving), np.full(steps, 3.0)], axis=1).astype(np.float32)


def decided(progress: Progress, features: np.ndarray) -> list:
    gate = ProgressGate(SupportGate(always(1.0), 0.0), progress)
    gate.reset(np.random.default_rng(0))
    return [
        gate.decide(Observation({}, row, step / 20), PROPOSED) for step, row in enumerate(features)
    ]


def test_the_expert_is_never_stuck_by_its_own_measure():
    episodes = [walked(0.1, pause) for pause in (0, 5, 12)]
    progress = Progress.of(episodes, STEPS)
    for episode in episodes:
        assert {each.actor for each in decided(progress, episode)} == {Actor.POLICY}


@pytest.mark.parametrize("sway", [0.0, 0.1])
def test_a_robot_that_stays_is_noticed_once_the_while_is_over(sway):
    progress = Progress.of([walked(0.1), walked(0.1, pause=5)], STEPS)
    stays = walked(0.1)
    stays[30:, 0] = stays[30, 0] + sway * np.sin(np.arange(50))
    decisions = decided(progress, stays)
    first = next(step for step, each in enumerate(decisions) if each.actor is Actor.EXPERT)
    assert 30 < first <= 30 + STEPS
    assert decisions[first].reason is Reason.STUCK
    assert decisions[first].query
    # The expert drives until something has moved: here nothing ever does.
    assert all(each.actor is Actor.EXPERT for each in decisions[30 + STEPS :])


def test_the_expert_hands_back_once_it_has_moved():
    progress = Progress.of([walked(0.1)], STEPS)
    stays = walked(0.1, pause=25)
    actors = [each.actor for each in decided(progress, stays)]
    assert Actor.EXPERT in actors
    assert actors[-1] is Actor.POLICY


def test_where_no_expert_episode_is_as_long_nothing_is_called_stuck():
    progress = Progress.of([walked(0.1, steps=10)], STEPS)
    assert progress.least == 0.0
    assert {each.actor for each in decided(progress, walked(0.0))} == {Actor.POLICY}


def test_what_was_learned_comes_back_and_something_else_is_refused():
    progress = Progress.of([walked(0.1, 3)], STEPS)
    again = Progress.load(progress.arrays())
    assert (again.steps, again.least) == (progress.steps, progress.least)
    assert again.motion(walked(0.02)) == progress.motion(walked(0.02))
    with pytest.raises(ParameterError, match="spread"):
        Progress.load({**progress.arrays(), "spread": np.zeros((2, 2))})


def test_without_features_nothing_is_said():
    bare = np.zeros((50, 0), np.float32)
    assert {each.actor for each in decided(Progress.of([bare], STEPS), bare)} == {Actor.POLICY}
