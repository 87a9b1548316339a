"""The last moments before a failure are labelled afterwards, and no others."""

import numpy as np
import pytest

from sheath_manip.gates.constant import AlwaysPolicy
from sheath_manip.gates.scheduled import ScheduledTakeovers
from sheath_manip.metrics import record_of
from sheath_manip.protocols import Gate
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Episode, EpisodeInfo, Outcome, Purpose
from tests.rollout.corridor_episode import SEED, Saying, Scripted, still
from tests.toy import CHOICES, Corridor, MiddleKeeper


def run(policy: Saying, expert=None, gate: Gate | None = None, seconds: float = 0.02) -> Episode:
    """An episode at 50 Hz."""
    environment = Corridor()
    return rollout(
        environment,
        EpisodeInfo("corridor", SEED, Purpose.LEARNING, 50.0),
        gate or AlwaysPolicy(),
        rng=np.random.default_rng(0),
        policy=policy,
        expert=expert or MiddleKeeper(environment),
        hindsight_s=seconds,
    )


def into_the_wall() -> Saying:
    return Saying(lambda _: CHOICES[2])


def test_before_a_failure_the_last_steps_have_what_the_expert_would_have_done():
    episode = run(into_the_wall())
    assert episode.outcome is Outcome.FAILURE
    assert [step.label is not None for step in episode.steps[-2:]] == [False, True]
    assert record_of(episode).queries == 1
    # Asked about at once it would have been the same.
    asked = run(into_the_wall(), gate=AlwaysPolicy(query=True), seconds=0)
    assert episode.steps[-1].label is not None
    np.testing.assert_array_equal(episode.steps[-1].label, asked.steps[-1].label)


def test_an_episode_that_does_not_fail_has_none():
    episode = run(still(), seconds=1.0)
    assert episode.outcome is Outcome.SUCCESS
    assert record_of(episode).queries == 0


def test_a_short_episode_is_labelled_from_its_start_and_the_experts_own_steps_stay():
    episode = run(into_the_wall(), gate=ScheduledTakeovers([(1, 1)]), seconds=9.0)
    assert episode.outcome is Outcome.FAILURE
    assert record_of(episode).queries == len(episode)
    assert record_of(episode).expert_steps == 1


@pytest.mark.filterwarnings("ignore")
def test_an_expert_that_has_no_answer_leaves_the_step_without_a_label():
    def answer(number: int) -> object:
        return "nonsense" if number == 1 else CHOICES[0]

    steps = run(into_the_wall(), Scripted(answer), seconds=9.0).steps
    assert [at for at, step in enumerate(steps) if step.label is None] == [1]
