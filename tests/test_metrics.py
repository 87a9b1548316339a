import math
from dataclasses import asdict, replace

import numpy as np
import pytest

from sheath_manip.metrics import (
    EpisodeRecord,
    bounded_interval,
    endings,
    endings_line,
    expert_share,
    figures_of,
    limited_share,
    mean_interval,
    rate_interval,
    record_of,
)
from sheath_manip.types import Limited, Outcome
from tests.episodes import episode_of


def record(outcome: Outcome, laps: float, steps: int = 10, expert: int = 0) -> EpisodeRecord:
    return EpisodeRecord(0, outcome, {"laps": laps}, steps, expert, 0, 0, 0)


@pytest.mark.parametrize(
    ("actors", "expert_steps", "switches", "interventions"),
    [
        ("pppp", 0, 0, 0),
        ("eeee", 4, 0, 1),
        ("ppee", 2, 1, 1),
        ("eepp", 2, 1, 1),
        ("peppe", 2, 3, 2),
        ("epepe", 3, 4, 3),
        ("e", 1, 0, 1),
    ],
)
def test_switches_and_interventions(actors, expert_steps, switches, interventions):
    counted = record_of(episode_of(actors))
    assert counted.steps == len(actors)
    assert counted.expert_steps == expert_steps
    assert counted.queries == expert_steps
    assert counted.switches == switches
    assert counted.interventions == interventions


def test_queries_are_labels_whoever_acts():
    assert record_of(episode_of("pepp", "xx.x")).queries == 3


def test_a_demonstration_holds_no_intervention():
    counted = record_of(episode_of("eeee", policy=False))
    assert (counted.expert_steps, counted.interventions) == (4, 0)


def test_limited_steps_are_counted_however_many_limits_acted():
    episode = episode_of("pppp")
    limited = ((), (Limited("a", 0.1),), (), (Limited("a", 0.1), Limited("b", 1.0)))
    steps = (replace(s, limited=each) for s, each in zip(episode.steps, limited, strict=True))
    counted = record_of(replace(episode, steps=tuple(steps)))
    assert counted.limited_steps == 2
    assert limited_share([counted, record_of(episode)]) == 0.25


def test_a_record_keeps_scene_outcome_and_metrics():
    counted = record_of(
        episode_of("pp", outcome=Outcome.FAILURE, metrics={"laps": 0.5}),
    )
    assert (counted.seed, counted.outcome, counted.metrics) == (7, Outcome.FAILURE, {"laps": 0.5})


@pytest.mark.parametrize(
    ("hits", "count", "low", "high"),
    [
        # (p + z²/2n ± z sqrt(p(1-p)/n + z²/4n²)) / (1 + z²/n), z = 1.959964; 81 of 263 is the
        # example of Newcombe 1998, table I: .2553 to .3662.
        (0, 10, 0.0, 0.27753),
        (1, 10, 0.01788, 0.40415),
        (5, 10, 0.23659, 0.76341),
        (10, 10, 0.72247, 1.0),
        (81, 263, 0.25529, 0.36621),
        (0, 0, 0.0, 1.0),
    ],
)
def test_wilsons_interval(hits, count, low, high):
    assert rate_interval(hits, count) == pytest.approx((low, high), abs=1e-5)


def test_students_interval():
    # t(0.975, 4) = 2.776445, standard deviation of 1..5 = 1.581139.
    half = 2.776445 * 1.581139 / math.sqrt(5)
    assert mean_interval(np.arange(1.0, 6.0)) == pytest.approx((3 - half, 3 + half), abs=1e-5)
    assert mean_interval(np.array([2.0])) == (2.0, 2.0)
    assert mean_interval(np.array([2.0, 2.0, 2.0])) == (2.0, 2.0)


def test_the_bootstraps_interval_stays_within_what_is_possible():
    near_the_top = np.array([1.0] * 23 + [0.2])
    low, high = bounded_interval(near_the_top)
    assert 0.85 < low < near_the_top.mean() < high <= 1.0
    # Student's does not.
    assert mean_interval(near_the_top)[1] > 1.0
    assert bounded_interval(near_the_top) == (low, high)
    # Of many values they agree.
    many = np.random.default_rng(1).uniform(size=400)
    assert bounded_interval(many) == pytest.approx(mean_interval(many), abs=0.003)
    assert bounded_interval(np.array([0.3])) == pytest.approx((0.3, 0.3))


def test_rates_and_means_of_a_set():
    outcomes = [Outcome.FAILURE, Outcome.SUCCESS, Outcome.SUCCESS, Outcome.TIME_LIMIT]
    laps = [0.1, 1.0, 1.0, 0.5]
    figures = figures_of([record(*pair) for pair in zip(outcomes, laps, strict=True)])
    assert (figures.episodes, figures.failure_rate, figures.success_rate) == (4, 0.25, 0.5)
    assert figures.metric == {"laps": pytest.approx(0.65)}
    assert figures.ci95["failure_rate"] == rate_interval(1, 4)
    low, high = figures.ci95["laps"]
    assert low < 0.65 < high


def test_nothing_says_nothing():
    figures = figures_of([])
    assert figures.episodes == 0
    assert math.isnan(figures.failure_rate)
    assert figures.ci95["failure_rate"] == (0.0, 1.0)
    assert math.isnan(expert_share([]))


def test_the_experts_share_is_of_steps_and_not_of_episodes():
    records = [
        record(Outcome.SUCCESS, 1.0, steps=90, expert=0),
        record(Outcome.FAILURE, 0.1, steps=10, expert=10),
    ]
    assert expert_share(records) == pytest.approx(0.1)


def test_what_neither_succeeded_nor_failed_is_stuck():
    records = [record(o, 1.0) for o in (Outcome.SUCCESS, Outcome.TIME_LIMIT, Outcome.TIME_LIMIT)]
    figures = figures_of(records)
    assert (figures.success_rate, figures.failure_rate) == (1 / 3, 0)
    assert figures.stuck_rate == 2 / 3
    assert figures.ci95["stuck_rate"] == rate_interval(2, 3)
    assert endings_line(each.outcome for each in records) == "1 succeeded, 0 failed, 2 stuck"
    assert endings_line([Outcome.ERROR]).endswith("0 stuck, 1 cut short")


def test_ways_to_end_are_told_of_an_older_summary_and_of_no_episodes():
    new = asdict(figures_of([record(o, 1.0) for o in [Outcome.TIME_LIMIT] * 3 + [Outcome.FAILURE]]))
    old = {name: value for name, value in new.items() if name != "stuck_rate"}
    assert endings(old) == endings(new)
    assert list(endings(new)) == ["succeeded", "failed", "stuck"]
    nothing = asdict(figures_of([])) | {"success_rate": None, "failure_rate": None}
    assert endings(nothing | {"stuck_rate": None})["stuck"][0] is None
