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


def noticed(progress: Progress, features: np.ndarray) -> int | None:
    """The first step in which the expert takes over."""
    decisions = decided(progress, features)
    return next((step for step, each in enumerate(decisions) if each.actor is Actor.EXPERT), None)


def path(ways: list[tuple[float, float]]) -> np.ndarray:
    """(n, 2) places along single steps."""
    return np.cumsum(np.array(ways), axis=0).astype(np.float32)


CIRCLE = [(0.1 * np.cos(at), 0.1 * np.sin(at)) for at in np.arange(80) * 2 * np.pi / 9]
"""nine steps a round"""
WAYS = {
    "stands still": [(0.0, 0.0)] * 80,
    "two actions in turns": [(0.1, 0.0), (-0.1, 0.0)] * 40,
    "to and fro": [*[(0.1, 0.0)] * 4, *[(-0.1, 0.0)] * 4] * 10,
    "in a circle": CIRCLE,
    "shivers": [(0.02 * np.sin(2.0 * at), 0.02 * np.cos(3.0 * at)) for at in range(80)],
}


@pytest.mark.parametrize("way", WAYS)
def test_who_gets_nowhere_is_noticed_within_the_while(way):
    walks = [path([(0.1, 0.02 * np.sin(at / 9)) for at in range(80)]) for _ in range(2)]
    progress = Progress.of(walks, STEPS)
    stays = np.concatenate([walks[0][:30], walks[0][30] + path(WAYS[way])])
    first = noticed(progress, stays)
    assert first is not None
    assert 30 < first <= 30 + STEPS
    decisions = decided(progress, stays)
    assert decisions[first].reason is Reason.STUCK
    assert decisions[first].query
    # The expert drives until the robot gets on: here it never does.
    assert all(each.actor is Actor.EXPERT for each in decisions[30 + STEPS :])


def test_who_is_slow_or_turns_back_once_gets_on():
    progress = Progress.of([walked(0.1)], STEPS)
    assert noticed(progress, walked(0.06)) is None
    there_and_back = np.concatenate([walked(0.1)[:40], walked(0.1)[40:0:-1]])
    # Half of the way back is a way that it has come; it is noticed for that, and only then.
    assert noticed(progress, there_and_back[:45]) is None


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
    np.testing.assert_array_equal(again.spread, progress.spread)
    older = {name: each for name, each in progress.arrays().items() if name != "least_got_on"}
    with pytest.raises(ParameterError, match="least_got_on"):
        # It measured something else.
        Progress.load({**older, "least": np.array(0.3)})
    with pytest.raises(ParameterError, match="spread"):
        Progress.load({**progress.arrays(), "spread": np.zeros((2, 2))})


def test_without_features_nothing_is_said():
    bare = np.zeros((50, 0), np.float32)
    assert {each.actor for each in decided(Progress.of([bare], STEPS), bare)} == {Actor.POLICY}
