"""What is asked of the expert: each burden apart, by one definition."""

import math
from dataclasses import replace

import pytest

from sheath_manip.burden import StepCounts, burden_of, counts_of
from sheath_manip.metrics import record_of
from sheath_manip.types import Actor, Reason
from tests.episodes import episode_of


def waiting(letters: str):
    """An episode at 10 Hz in which nobody drives where there is an `h`."""
    episode = episode_of(letters.replace("h", "e"))
    steps = [
        replace(step, decision=replace(step.decision, actor=Actor.HOLD, reason=Reason.WAITING))
        if letter == "h"
        else step
        for step, letter in zip(episode.steps, letters, strict=True)
    ]
    return record_of(replace(episode, steps=tuple(steps)))


def test_takeovers_driving_and_labels_are_counted_apart():
    records = [
        record_of(episode_of("ppeeeeppeepp", "xx" + "x" * 4 + ".." + "xx" + "..")),
        record_of(episode_of("pppppppp")),
    ]
    found = burden_of(records)
    assert found.takeovers_an_episode == 1
    # 20 steps at 10 Hz are 2 seconds.
    assert found.takeovers_a_minute == pytest.approx(2 / (2 / 60))
    assert found.median_takeover_s == pytest.approx(0.3)
    assert found.driving_s_an_episode == pytest.approx(0.3)
    assert found.labels_an_episode == 4


def test_to_wait_is_no_driving_and_no_minute():
    record = waiting("pp" + "hhhhhh" + "eeee" + "pppp")
    assert record.turns == (4,)
    counts = counts_of(record)
    assert (counts.takeovers, counts.active_s, counts.driving_s) == (1, 1.0, 0.4)
    assert burden_of([record]).takeovers_a_minute == pytest.approx(60)


def test_where_there_is_no_policy_nobody_takes_over():
    found = burden_of([record_of(episode_of("eeee", policy=False))])
    assert (found.takeovers_an_episode, found.driving_s_an_episode) == (0, 0.4)
    assert math.isnan(found.median_takeover_s)


def test_of_nothing_nothing_is_said():
    found = burden_of([])
    assert all(map(math.isnan, vars(found).values()))
    assert StepCounts().expert_share == 0


def test_counts_add_up():
    records = [record_of(episode_of(letters)) for letters in ("ppee", "epep")]
    both = counts_of(records[0]) + counts_of(records[1])
    assert (both.episodes, both.takeovers, both.driving_steps, both.labels) == (2, 3, 4, 4)
    assert both.takeovers_an_episode == burden_of(records).takeovers_an_episode
