import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError, UnscoredError
from sheath_manip.support.calibration import (
    REJECT_ALL,
    budget_threshold,
    episode_threshold,
    held_out_threshold,
    level_threshold,
    or_reject_all,
    planned_threshold,
)
from sheath_manip.support.config import ThresholdConfig


def test_the_expected_share_of_new_steps_is_the_asked_rate():
    rng = np.random.default_rng(0)
    # Of uniform scores, the share below the threshold is the threshold itself.
    shares = [
        held_out_threshold([rng.uniform(size=60) for _ in range(5)], 0.05) for _ in range(500)
    ]
    assert np.mean(shares) == pytest.approx(0.05, abs=0.002)


def test_a_small_sample_is_corrected():
    rng = np.random.default_rng(1)
    shares = [held_out_threshold([rng.uniform(size=4) for _ in range(3)], 0.2) for _ in range(2000)]
    assert 0.1 < np.mean(shares) <= 0.2


def test_alike_within_an_episode_the_share_keeps_its_bound():
    rng = np.random.default_rng(3)
    shares = []
    for _ in range(2000):
        *held_out, new = rng.normal(size=(6, 1)) + 0.1 * rng.normal(size=(6, 30))
        shares.append((new < held_out_threshold(held_out, 0.1)).mean())
    assert np.mean(shares) <= (0.1 * 5 + 1) / (5 + 1)


def test_episodes_count_alike_however_long():
    scores = [np.full(1000, 1.0), np.full(10, 2.0), np.full(10, 3.0)]
    assert held_out_threshold(scores, 0.30) == 1.0
    assert held_out_threshold(scores, 0.40) == 2.0


def test_a_missing_score_counts_as_an_alarm():
    scores = [np.linspace(0, 1, 101) for _ in range(3)]
    complete = held_out_threshold(scores, 0.1)
    for episode in scores:
        episode[-5:] = np.nan
    assert held_out_threshold(scores, 0.1) == pytest.approx(complete - 0.05)


def test_the_share_below_the_threshold_never_exceeds_the_rate():
    rng = np.random.default_rng(2)
    for rate in (0.01, 0.05, 0.5, 0.99):
        scores = [rng.integers(0, 5, size=n).astype(float) for n in (70, 90, 200, 30)]
        threshold = held_out_threshold(scores, rate)
        assert np.mean([(episode < threshold).mean() for episode in scores]) <= rate


@pytest.mark.parametrize(
    ("episodes", "rate", "message"),
    [
        ([np.ones(100)] * 2, 0.05, "at least 3"),
        ([np.ones(100), np.ones(100), np.ones(0)], 0.05, "at least 3"),
        ([np.ones(100)] * 3, 0.0, "false_alarm_rate"),
        ([np.ones(100)] * 3, 1.0, "false_alarm_rate"),
        ([np.ones(100)] * 3, float("nan"), "false_alarm_rate"),
        ([np.ones(3)] * 3, 0.05, "wanted at least 20"),
        ([np.full(100, np.nan)] * 3, 0.05, "300 of them without a score"),
    ],
)
def test_what_cannot_be_calibrated(episodes, rate, message):
    with pytest.raises(ParameterError, match=message):
        held_out_threshold(episodes, rate)


def test_where_scores_are_missing_nothing_is_inside():
    unscored = [np.full(100, np.nan)] * 3
    assert or_reject_all(lambda: held_out_threshold(unscored, 0.05)) == REJECT_ALL
    with pytest.raises(ParameterError, match="at least 3"):
        or_reject_all(lambda: held_out_threshold(unscored[:2], 0.05))


@pytest.mark.parametrize(("episodes", "alpha"), [(9, 0.1), (20, 0.1), (30, 0.25), (4, 0.2)])
def test_an_episode_alarms_anywhere_with_at_most_the_asked_probability(episodes, alpha):
    rng = np.random.default_rng(4)
    alarms = []
    for _ in range(3000):
        # Steps of an episode resemble each other.
        *held_out, new = rng.normal(size=(episodes + 1, 1)) + rng.normal(size=(episodes + 1, 20))
        alarms.append((new < episode_threshold(held_out, alpha)).any())
    assert alpha - 1 / (episodes + 1) - 0.02 < np.mean(alarms) < alpha + 0.02


def test_an_episode_counts_by_its_lowest_score():
    lowest = np.arange(19.0)
    scores = [np.array([50.0, low, 60.0]) for low in lowest[::-1]]
    assert episode_threshold(scores, 0.1) == 1.0
    scores[0][0] = np.nan
    assert episode_threshold(scores, 0.1) == 0.0


@pytest.mark.parametrize(
    ("episodes", "alpha", "message"),
    [
        ([np.ones(5)] * 8, 0.1, "8 held-out episodes, 0 of them .* wanted at least 9"),
        ([np.ones(5)] * 8 + [np.array([1, np.nan])], 0.1, "1 of them .* wanted at least 19"),
        ([], 0.5, "0 held-out episodes"),
        ([np.ones(5)] * 9, 1.0, "alarm_probability is 1.0; wanted"),
    ],
)
def test_episodes_that_cannot_hold_the_probability(episodes, alpha, message):
    with pytest.raises(ParameterError, match=message):
        episode_threshold(episodes, alpha)


@pytest.mark.parametrize("share", [0.01, 0.1, 0.3, 0.9])
def test_the_budget_is_the_share_of_steps_below_the_threshold(share):
    scores = np.random.default_rng(5).normal(size=1000)
    assert (scores < budget_threshold(scores, share)).mean() == pytest.approx(share)


def test_missing_and_equal_scores_never_overdraw_the_budget():
    scores = np.random.default_rng(6).integers(0, 6, size=500).astype(float)
    scores[:40] = np.nan
    for share in (0.09, 0.3, 0.6):
        assert (~(scores >= budget_threshold(scores, share))).mean() <= share


@pytest.mark.parametrize(
    ("scores", "share", "message"),
    [
        (np.ones(5), 0.1, "5 steps, 0 of them .* wanted at least 10"),
        (np.r_[np.full(30, np.nan), np.ones(70)], 0.2, "30 of them without a score"),
        (np.empty(0), 0.5, "0 steps"),
        (np.ones(100), 0.0, "expert_share is 0.0; wanted"),
    ],
)
def test_steps_that_cannot_hold_the_budget(scores, share, message):
    with pytest.raises(ParameterError, match=message):
        budget_threshold(scores, share)


def test_a_level_is_a_share_of_the_experts_steps_or_a_distance_below_them():
    scores = np.linspace(0, 10, 101)
    assert level_threshold([scores[:50], scores[50:]], 0.1) == pytest.approx(1.0)
    assert level_threshold([scores], 0.0) == 0.0
    assert level_threshold([scores], -0.5) == pytest.approx(-2.5)
    levels = [-2.0, -0.5, 0.0, 0.01, 0.5]
    assert (np.diff([level_threshold([scores], level) for level in levels]) > 0).all()


def test_a_level_wants_scores_and_less_than_all_of_them():
    with pytest.raises(ParameterError, match="wanted less than 1"):
        level_threshold([np.zeros(3)], 1.0)
    with pytest.raises(UnscoredError, match="wanted one at least"):
        level_threshold([np.full(3, np.nan)], 0.0)
    with pytest.raises(ParameterError, match="wanted less than 1"):
        ThresholdConfig(level=1.0)
    assert planned_threshold([np.full(3, np.nan)], [], ThresholdConfig("level")) == REJECT_ALL
    assert planned_threshold([np.arange(5.0)], [], ThresholdConfig("level", level=-1.0)) == -2.0
