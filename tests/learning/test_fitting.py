"""From a fitted policy to its gate."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.support.config import ThresholdConfig
from tests.blobs import blob_samples, fitted_policy, training

CONFIG = GateConfig(
    signal="support", embedding="pixels", threshold=ThresholdConfig(false_alarm_rate=0.2)
)
CALIBRATION = [blob_samples(50, seed=10 + i) for i in range(5)]


def ruled(**values) -> GateConfig:
    return replace(CONFIG, threshold=replace(CONFIG.threshold, **values))


def gate(config: GateConfig, **options) -> Checkpoint:
    policy = fitted_policy("hog-svm")
    return fit_gate(
        policy, training(), CALIBRATION, config, "blobs", policy_name="hog-svm", **options
    )


def alarms(checkpoint: Checkpoint, samples) -> float:
    return float(np.mean(checkpoint.scores(samples) < checkpoint.threshold))


def test_the_threshold_keeps_the_asked_rate_of_held_out_steps():
    fitted = gate(CONFIG)
    assert np.mean([alarms(fitted, one) for one in CALIBRATION]) == pytest.approx(0.2, abs=0.02)


def test_or_the_probability_that_an_episode_alarms_at_all():
    fitted = gate(ruled(rule="episodes"))
    assert sum(alarms(fitted, one) > 0 for one in CALIBRATION) <= 1
    assert fitted.threshold < gate(CONFIG).threshold


def test_or_the_share_of_what_was_met_last():
    plan = ruled(rule="budget", expert_budget=0.3)
    met = blob_samples(100, seed=20, choices=(2,))
    assert alarms(gate(plan, visited=met), met) == pytest.approx(0.3, abs=0.02)
    # Before the policy has driven, the expert's own steps stand in.
    assert np.mean([alarms(gate(plan), one) for one in CALIBRATION]) == pytest.approx(0.3, abs=0.02)


def test_calibrated_once_the_threshold_stays():
    first = replace(gate(CONFIG), threshold=0.123)
    assert gate(ruled(recalibrate=False), previous=first).threshold == 0.123
    assert gate(CONFIG, previous=first).threshold != 0.123
    assert gate(ruled(recalibrate=False)).threshold == gate(CONFIG).threshold


def test_an_unknown_rule_is_told():
    with pytest.raises(UnknownNameError, match=r"threshold rule 'guess'.*budget"):
        gate(ruled(rule="guess"))
