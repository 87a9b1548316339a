"""From a fitted policy to its gate."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.fitting import fit_gate
from tests.blobs import blob_samples, fitted_policy, training

PLAN = LearningPlan(policy="hog-svm", signal="support", embedding="pixels", false_alarm_rate=0.2)
CALIBRATION = [blob_samples(50, seed=10 + i) for i in range(5)]


def gate(plan: LearningPlan, **options) -> Checkpoint:
    return fit_gate(fitted_policy("hog-svm"), training(), CALIBRATION, plan, "blobs", **options)


def alarms(checkpoint: Checkpoint, samples) -> float:
    return float(np.mean(checkpoint.scores(samples) < checkpoint.threshold))


def test_the_threshold_keeps_the_asked_rate_of_held_out_steps():
    fitted = gate(PLAN)
    assert np.mean([alarms(fitted, one) for one in CALIBRATION]) == pytest.approx(0.2, abs=0.02)


def test_or_the_probability_that_an_episode_alarms_at_all():
    fitted = gate(replace(PLAN, threshold_rule="episodes"))
    assert sum(alarms(fitted, one) > 0 for one in CALIBRATION) <= 1
    assert fitted.threshold < gate(PLAN).threshold


def test_or_the_share_of_what_was_met_last():
    plan = replace(PLAN, threshold_rule="budget", expert_budget=0.3)
    met = blob_samples(100, seed=20, choices=(2,))
    assert alarms(gate(plan, visited=met), met) == pytest.approx(0.3, abs=0.02)
    # Before the policy has driven, the expert's own steps stand in.
    assert np.mean([alarms(gate(plan), one) for one in CALIBRATION]) == pytest.approx(0.3, abs=0.02)


def test_calibrated_once_the_threshold_stays():
    first = replace(gate(PLAN), threshold=0.123)
    assert gate(replace(PLAN, recalibrate=False), previous=first).threshold == 0.123
    assert gate(PLAN, previous=first).threshold != 0.123
    assert gate(replace(PLAN, recalibrate=False)).threshold == gate(PLAN).threshold


def test_an_unknown_rule_is_told():
    with pytest.raises(UnknownNameError, match=r"threshold rule 'guess'.*budget"):
        gate(replace(PLAN, threshold_rule="guess"))
