"""AUROC, ROC and alarms on scores made by hand."""

import numpy as np
import pytest

from sheath_manip.experiments.gates.detection import Rate, auroc, detected
from sheath_manip.experiments.gates.foresight import (
    Drive,
    before_failure,
    failure_free,
    foresight,
    lead_steps,
    window_scores,
)


def scores(text: str) -> np.ndarray:
    """One score a letter: o inside, x outside, n not a number."""
    return np.array([{"o": 1.0, "x": -1.0, "n": np.nan}[letter] for letter in text])


def test_auroc_is_the_chance_to_score_lower():
    assert auroc(np.array([2.0, 3.0]), np.array([0.0, 1.0])) == 1
    assert auroc(np.array([0.0, 1.0]), np.array([2.0, 3.0])) == 0
    assert auroc(np.array([1.0, 3.0]), np.array([2.0, 0.0])) == 0.75
    assert auroc(np.ones(5), np.ones(3)) == 0.5
    # Without a score it is outside.
    assert auroc(np.array([0.0]), np.array([np.nan])) == 1
    assert np.isnan(auroc(np.array([1.0]), np.empty(0)))


def test_detection_takes_the_highest_threshold_that_a_rate_allows():
    inside, outside = np.arange(10.0), np.array([-1.0, 1.5, 2.5, 20.0])
    found = detected(inside, outside, np.array([0.0, 0.1, 0.3, 0.39, 1.0]))
    assert found.tolist() == [0.25, 0.25, 0.75, 0.75, 1.0]
    assert np.isnan(detected(inside, np.empty(0), np.array([0.2]))).all()


def test_the_area_under_the_detection_curve_is_the_auroc():
    rng = np.random.default_rng(0)
    inside, outside = rng.normal(1, 1, 2000), rng.normal(0, 1, 500)
    rates = np.linspace(0, 1, 2001)
    area = np.trapezoid(detected(inside, outside, rates), rates)
    assert area == pytest.approx(auroc(inside, outside), abs=1e-3)


def test_a_rate_knows_its_interval():
    assert Rate(1, 4).value == 0.25
    low, high = Rate(1, 4).ci95
    assert low < 0.25 < high
    assert np.isnan(Rate(0, 0).value)


@pytest.mark.parametrize(
    ("drive", "lead"),
    [
        ("oooooooxo", 1),
        ("oooooooox", None),  # the failing step itself is too late
        ("ooooooxoo", 2),
        ("oxxxxxxxo", 7),  # the run began before the window
        ("oxoooxxoo", 3),
        ("xxoooooon", None),
        ("ooooonooo", 3),
        ("o", None),
    ],
)
def test_the_lead_is_counted_from_where_the_alarm_began(drive, lead):
    assert lead_steps(scores(drive), 0.0, window=4) == lead


def test_windows_follow_each_other_and_spare_what_leads_to_a_failure():
    assert window_scores(np.arange(7.0), 3).tolist() == [0, 3]
    assert window_scores(np.arange(2.0), 3).tolist() == []
    drives = [Drive(np.arange(7.0), failed=False), Drive(np.arange(10.0, 21.0), failed=True)]
    assert failure_free(drives, 3, spared=5).tolist() == [0, 3, 10, 13]
    assert before_failure(drives, 3).tolist() == [17]


def test_foresight_counts_failures_windows_and_episodes():
    drives = [
        Drive(scores("ooooooooxxoo"), failed=True),
        Drive(scores("xooooooooooo"), failed=True),
        Drive(scores("ooooooooooox"), failed=True),
        Drive(scores("oooooooooooo"), failed=False),
        Drive(scores("oooxoooooooo"), failed=False),
    ]
    found = foresight(drives, 0.0, window=4, spared=6)
    assert (found.foreseen.hits, found.foreseen.count) == (1, 3)
    assert found.lead_steps == 3
    # One window of each failed drive, three of each other one.
    assert (found.disturbed.hits, found.disturbed.count) == (2, 9)
    assert (found.failed.hits, found.failed.count) == (2, 3)
    assert (found.unfailed.hits, found.unfailed.count) == (1, 2)


def test_without_failures_nothing_is_foreseen():
    found = foresight([Drive(scores("oooo"), failed=False)], 0.0, window=2, spared=2)
    assert found.foreseen.count == 0
    assert np.isnan(found.lead_steps)
