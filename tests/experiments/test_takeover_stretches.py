"""Scenes that are stretches of episodes: where they lie, and when they are over."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.takeovers.alone import scenes_of
from sheath_manip.experiments.takeovers.plan import TUNING, TakeoversPlan
from sheath_manip.experiments.takeovers.stretch import Stretch, StretchEnvironment
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.types import Episode, Outcome
from tests.episodes import episode_of
from tests.toy import STUDY, Corridor

STRETCH_S = 0.1
STEPS = 5
"""of the corridor at 50 Hz"""


@pytest.fixture
def at() -> Watched:
    plan = TakeoversPlan(stretch_s=STRETCH_S)
    return Watched(STUDY, plan, Path("nowhere"), 0, 0)


def lasting(steps: int, outcome: Outcome) -> Episode:
    return episode_of("p" * steps, outcome=outcome)


def test_a_failure_lies_in_a_stretch_and_not_at_its_beginning(at):
    spec = at.spec()
    for index in range(30):
        episode = lasting(23, Outcome.FAILURE)
        found = scenes_of(at, spec, TUNING, index, episode)
        failing, before = found.scenes
        assert (found.episodes, found.failing) == (5, 1)
        assert failing.failing
        assert not before.failing
        assert 23 - 3 * STEPS // 4 <= failing.first_step <= 23 - STEPS // 4
        assert before.first_step == failing.first_step - STEPS
        alone = Stretch.of(episode, failing.first_step, STEPS)
        assert (alone.outcome, len(alone)) == (Outcome.FAILURE, 23 - failing.first_step)
        alone = Stretch.of(episode, before.first_step, STEPS)
        assert (alone.outcome, len(alone)) == (Outcome.SUCCESS, STEPS)


def test_standing_still_fails_no_stretch_and_a_whole_episode(at):
    episode = lasting(12, Outcome.TIME_LIMIT)
    assert scenes_of(at, at.spec(), TUNING, 0, episode).failing == 0
    whole = replace(at, plan=replace(at.plan, stretch_s=None))
    found = scenes_of(whole, at.spec(), TUNING, 0, episode)
    assert (found.episodes, found.failing, found.stuck) == (1, 1, 1)


def test_a_stretch_is_over_after_its_steps_and_well_unless_the_task_fails():
    environment = StretchEnvironment(Corridor(12))
    environment.reset(0)
    state = environment.state()
    environment.steps_left = 3
    ends = [environment.step(np.zeros(1, np.float32)).truncated for _ in range(3)]
    assert ends == [False, False, True]
    assert environment.outcome() is Outcome.SUCCESS
    environment.restore(state)
    environment.steps_left = 3
    transition = environment.step(np.full(1, 5.0, np.float32))
    assert (transition.terminated, environment.outcome()) == (True, Outcome.FAILURE)
    environment.steps_left = None
    environment.restore(state)
    assert not any(environment.step(np.zeros(1, np.float32)).truncated for _ in range(3))


def test_what_a_hold_asks_of_the_tasks_environment_is_passed_on():
    assert StretchEnvironment(Corridor(12)).steps == 12


def test_an_environment_that_cannot_be_restored_has_no_scenes_to_go_on_with():
    class Flowing:
        """What no state can be read of."""

    with pytest.raises(ParameterError, match="can be restored"):
        StretchEnvironment(Flowing())  # pyright: ignore[reportArgumentType]
