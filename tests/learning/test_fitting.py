"""From a fitted policy to its gate."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import GateWarning, UnknownNameError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.learning import fitting
from sheath_manip.learning.fitting import fit_gate, fitted_rows, recalibrated
from sheath_manip.support.calibration import REJECT_ALL
from sheath_manip.support.config import SupportConfig, ThresholdConfig
from sheath_manip.types.samples import Samples
from tests.blobs import CHOICES, blob_samples, fitted_policy, training

CONFIG = GateConfig(
    signal="support", embedding="pixels", threshold=ThresholdConfig(false_alarm_rate=0.2)
)
CALIBRATION = [blob_samples(50, seed=10 + i) for i in range(5)]


def ruled(**values) -> GateConfig:
    return replace(CONFIG, threshold=replace(CONFIG.threshold, **values))


SOURCES = Sources(("training",), tuple(f"held-out-{number}" for number in range(5)))


def gate(config: GateConfig, **options) -> FittedGate:
    policy = fitted_policy("hog-svm")
    return fit_gate(policy, training(), CALIBRATION, config, sources=SOURCES, **options).gate


def alarms(fitted: FittedGate, samples: Samples) -> float:
    return float(np.mean(fitted.scores(samples) < fitted.threshold))


def test_the_threshold_keeps_the_asked_rate_of_held_out_steps():
    fitted = gate(CONFIG)
    assert np.mean([alarms(fitted, one) for one in CALIBRATION]) == pytest.approx(0.2, abs=0.02)


def test_or_the_probability_that_an_episode_alarms_at_all():
    with pytest.warns(GateWarning, match="may never take over"):
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


def test_what_was_looked_at_for_the_fit_is_kept_with_it():
    policy = fitted_policy("hog-svm")
    fit = fit_gate(policy, training(), CALIBRATION, CONFIG, sources=SOURCES)
    assert fit.gate.sources == SOURCES
    losses = policy.surrogate_losses(
        policy.propose(training().observations), np.asarray(training().labels)
    )
    assert fit.training_loss == pytest.approx(float(np.mean(losses)))
    again = np.concatenate([fit.gate.scores_of(seen) for seen in fit.looks.calibration])
    apart = np.concatenate([fit.gate.scores(one) for one in CALIBRATION])
    np.testing.assert_array_equal(again, apart)


def test_found_again_the_threshold_is_the_same_and_a_budget_asks_what_was_met():
    fitted = gate(ruled(rule="budget", expert_budget=0.3))
    assert recalibrated(fitted, CALIBRATION).threshold == fitted.threshold
    met = blob_samples(100, seed=20, choices=(2,))
    assert alarms(recalibrated(fitted, CALIBRATION, met), met) == pytest.approx(0.3, abs=0.02)


def test_the_expert_hands_back_at_the_release_rate():
    fitted = gate(replace(CONFIG, release_rate=0.5))
    scores = np.concatenate([fitted.scores(one) for one in CALIBRATION])
    release = fitted.threshold + fitted.release_margin
    assert np.mean(scores < release) == pytest.approx(0.5, abs=0.03)
    assert gate(CONFIG).release_margin == 0


LOSS_AWARE = replace(CONFIG, support=SupportConfig("loss-aware-svm"))
RIGHT_TURNS = training().labels[:, 0] == CHOICES[2]
WITHOUT_RIGHT_TURNS = [blob_samples(50, seed=10 + i, choices=(0, 1)) for i in range(5)]


def loss_aware(calibration: Sequence[Samples], errs: np.ndarray) -> FittedGate:
    """The gate of a policy that errs, as fits that had not seen the states say."""
    policy = fitted_policy("hog-svm")
    fit = fit_gate(
        policy,
        training(),
        calibration,
        LOSS_AWARE,
        sources=SOURCES,
        agreement=lambda: np.logical_not(errs),
    )
    return fit.gate


def test_a_loss_aware_gate_is_outside_where_the_policy_errs_and_keeps_the_rate_elsewhere():
    fitted = loss_aware(WITHOUT_RIGHT_TURNS, RIGHT_TURNS)
    assert np.mean([alarms(fitted, one) for one in WITHOUT_RIGHT_TURNS]) == pytest.approx(
        0.2, abs=0.02
    )
    assert alarms(fitted, blob_samples(50, seed=30, choices=(2,))) > 0.9


def test_where_the_policy_errs_too_often_a_loss_aware_gate_lets_it_act_nowhere():
    """More held-out states have no score for any threshold than there may be false alarms."""
    fitted = loss_aware(CALIBRATION, training().labels[:, 0] != CHOICES[0])
    assert fitted.threshold == REJECT_ALL
    assert all(alarms(fitted, one) == 1 for one in CALIBRATION)


def test_of_many_states_a_gate_is_fitted_to_some_from_everywhere(monkeypatch):
    monkeypatch.setattr(fitting, "MOST_STATES", 40)
    policy, states = fitted_policy("hog-svm"), training()
    assert len(states) > 40
    rows, asked = fitted_rows(len(states)), []

    def agreement() -> np.ndarray:
        asked.append(len(states))
        return np.arange(len(states)) % 2 == 0

    config = replace(CONFIG, support=SupportConfig(name="loss-aware-svm"))
    fit = fit_gate(policy, states, CALIBRATION, config, sources=SOURCES, agreement=agreement)
    assert (len(fit.looks.states), asked) == (40, [len(states)])
    assert np.array_equal(fit.looks.labels, states.labels[rows])
    again = fit_gate(policy, states, CALIBRATION, config, sources=SOURCES, agreement=agreement)
    assert again.gate.threshold == fit.gate.threshold
    assert np.array_equal(fitted_rows(40), np.arange(40))
    assert len(np.unique(fitted_rows(1000))) == 40
    assert fitted_rows(1000).max() > 900


def test_of_few_states_all_are_taken():
    fit = fit_gate(fitted_policy("hog-svm"), training(), CALIBRATION, CONFIG, sources=SOURCES)
    assert np.array_equal(fit.looks.labels, training().labels)
