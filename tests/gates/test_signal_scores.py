"""What a score is made of, in a judgement and in every decision that is made of it."""

from dataclasses import dataclass

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import QueryFilter, SupportGate
from sheath_manip.gates.held_out import HeldOut
from sheath_manip.gates.patient import PatientGate, RequestConfig
from sheath_manip.signals.joined import Reference
from sheath_manip.types import Judgement, Observation, Proposal, Reason, SignalScore

SIGNALS = (SignalScore("precedent", -2.0, 0.01), SignalScore("support", 0.5, 0.4))
PROPOSAL = Proposal(np.zeros((1, 1), np.float32))
OBSERVATION = Observation({}, np.zeros(1, np.float32), 0.0)


@dataclass(frozen=True)
class Judged:
    score: float

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        del observation, proposal, threshold
        return Judgement(self.score, Reason.RISK, SIGNALS)


@pytest.mark.parametrize("score", [-1.0, 1.0, np.nan])
def test_every_decision_tells_what_its_score_is_made_of(score: float) -> None:
    gates = (
        SupportGate(Judged(score), 0.0),
        QueryFilter(Judged(score), 0.0),
        PatientGate(SupportGate(Judged(score), 0.0), RequestConfig(turn_s=1.0)),
    )
    for gate in gates:
        gate.reset(np.random.default_rng(0))
        assert gate.decide(OBSERVATION, PROPOSAL).signals == SIGNALS
        assert gate.decide(OBSERVATION, None).signals == ()


def test_a_share_counts_the_expert_steps_that_score_lower() -> None:
    scores = np.array([-1.0, 0.0, 0.0, 3.0])
    reference, held_out = Reference.of(scores), HeldOut.of([scores[2:], scores[:2]])
    for score, share in ((-2.0, 0.0), (-1.0, 0.0), (0.0, 0.25), (1.0, 0.75), (4.0, 1.0)):
        assert reference.share(score) == held_out.share(score) == share


def test_held_out_scores_come_back_from_arrays() -> None:
    held_out = HeldOut.of([np.array([0.5, np.nan]), np.array([]), np.array([-np.inf])])
    loaded = HeldOut.load(held_out.arrays())
    assert [each.tolist() for each in loaded.episodes] == [[0.5, -np.inf], [], [-np.inf]]
    assert HeldOut.load({}).episodes == () == HeldOut.load(HeldOut().arrays()).episodes
    assert np.isnan(HeldOut().share(0.0))
    with pytest.raises(ParameterError, match="3 scores; wanted 4"):
        HeldOut.load({**held_out.arrays(), "lengths": np.array([4])})
