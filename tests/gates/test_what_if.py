"""The preview of a threshold, held against the gates whose decisions it foretells."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sheath_manip.gates import SupportGate
from sheath_manip.gates.doses import DosedGate
from sheath_manip.gates.patient import PatientGate, RequestConfig
from sheath_manip.gates.what_if import ScoredEpisode, TurnRule, expert_turns, preview
from sheath_manip.protocols import Gate
from sheath_manip.types import Actor, Observation, Proposal
from tests.cases import cases
from tests.judging import ByObservation

RATE_HZ = 0.2
"""so that a minute is a few steps"""
PROPOSAL = Proposal(np.zeros((1, 1), np.float32))
some_scores = st.lists(st.sampled_from([-1.0, -0.1, 0.0, 0.2, 1.0, np.nan]), max_size=60)
rules = st.builds(
    TurnRule,
    threshold=st.sampled_from([-0.5, 0.0, 0.2]),
    minimum_hold_steps=st.integers(0, 4),
    release_margin=st.sampled_from([0.0, 0.3]),
    quiet_steps=st.integers(0, 3),
    a_minute=st.integers(0, 2),
)
dosed_rules = st.builds(
    TurnRule, threshold=st.sampled_from([-0.5, 0.2]), dose_every_steps=st.integers(2, 5)
)


def by_the_gates(scores: list[float], rule: TurnRule) -> NDArray[np.bool_]:
    judge = ByObservation(lambda observation: float(observation.features[0]))
    gate: Gate = SupportGate(
        judge,
        rule.threshold,
        release_margin=rule.release_margin,
        quiet_steps=rule.quiet_steps,
        minimum_hold_steps=rule.minimum_hold_steps,
    )
    if rule.dose_every_steps:
        gate = DosedGate(gate, rule.dose_every_steps)
    gate = PatientGate(gate, RequestConfig(a_minute=rule.a_minute))
    gate.reset(np.random.default_rng(0))
    decisions = [
        gate.decide(Observation({}, np.array([score]), step / RATE_HZ), PROPOSAL)
        for step, score in enumerate(scores)
    ]
    return np.array([each.actor is Actor.EXPERT for each in decisions], bool)


@cases(200)
@given(some_scores, rules | dosed_rules)
def test_it_foretells_what_the_gates_decide(scores: list[float], rule: TurnRule) -> None:
    foretold = expert_turns(np.array(scores, np.float64), rule, RATE_HZ)
    np.testing.assert_array_equal(foretold, by_the_gates(scores, rule))


def test_a_preview_counts_share_requests_false_alarms_and_failures() -> None:
    episodes = [
        ScoredEpisode(np.array([1.0, -1.0, 1.0, -1.0]), failed=True),
        ScoredEpisode(np.array([1.0, 1.0, 1.0, -1.0]), failed=True),
        ScoredEpisode(np.array([1.0, 1.0, -1.0, -1.0]), failed=False),
        ScoredEpisode(np.array([1.0, 1.0, 1.0, 1.0]), failed=False),
    ]
    held_out = [np.array([1.0, 0.5, -np.inf]), np.array([1.0, 1.0])]
    found = preview(episodes, held_out, TurnRule(0.0), control_rate_hz=1.0)
    assert found.steps == 16
    assert found.expert_share == 5 / 16
    assert found.requests_a_minute == pytest.approx(4 / (16 / 60))
    assert found.false_alarm_share == 1 / 5
    assert found.false_alarm_episodes == (1, 2)
    # An alarm in the failing step itself comes too late.
    assert found.foreseen == (1, 2)
    assert found.needless == (1, 2)
    assert found.first_request == (1, 3, 2, None)
    longer = preview(episodes, held_out, TurnRule(0.0, minimum_hold_steps=2), 1.0)
    assert longer.expert_share == 6 / 16
    assert preview(episodes, held_out, TurnRule(-np.inf), 1.0).first_request == (None,) * 4


def test_of_nothing_there_is_no_share() -> None:
    nothing = preview([], [], TurnRule(0.0), 1.0)
    assert nothing.steps == 0
    shares = (nothing.expert_share, nothing.requests_a_minute, nothing.false_alarm_share)
    assert np.isnan(shares).all()
