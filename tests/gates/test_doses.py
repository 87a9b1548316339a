"""A gate whose expert acts in doses: one step in so many of an alarm, but all without a score."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.doses import DosedGate
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.gates.support import SupportGate
from sheath_manip.types import Actor, Observation, Proposal, Reason
from tests.judging import ByObservation

PROPOSED = Proposal(np.zeros((1, 1), np.float32))


def driven(scores: list[float], every_steps: int) -> list[tuple[Actor, Reason]]:
    """Who acts in each step, by its score, in the second of two equal episodes."""
    judge = ByObservation(lambda seen: float(seen.features[0]))
    gate = DosedGate(SupportGate(judge, 0.0), every_steps)
    decisions = []
    for _ in range(2):
        gate.reset(np.random.default_rng(0))
        decisions = [
            gate.decide(Observation({}, np.array([score], np.float32), 0.0), PROPOSED)
            for score in scores
        ]
    return [(decision.actor, decision.reason) for decision in decisions]


def expert_steps(decisions: list[tuple[Actor, Reason]]) -> list[int]:
    return [step for step, (actor, _) in enumerate(decisions) if actor is Actor.EXPERT]


def test_of_an_alarm_the_expert_takes_one_step_in_so_many() -> None:
    decisions = driven([1, -1, -1, -1, -1, -1, -1, 1], 3)
    assert expert_steps(decisions) == [1, 4]
    assert decisions[2] == (Actor.POLICY, Reason.FIXED)
    assert decisions[7] == (Actor.POLICY, Reason.INSIDE)


def test_a_new_alarm_soon_after_waits_and_a_later_one_does_not() -> None:
    assert expert_steps(driven([-1, 1, -1, -1, 1, 1, 1, -1], 3)) == [0, 3, 7]


def test_without_a_score_the_expert_acts_in_all_steps() -> None:
    assert expert_steps(driven([-1, np.nan, np.nan, 1], 3)) == [0, 1, 2]


def test_a_dose_is_one_step_and_no_request_of_a_person() -> None:
    with pytest.raises(ParameterError, match="dose_every_steps is 1; wanted 0 or at least 2"):
        GateConfig(dose_every_steps=1)
    with pytest.raises(ParameterError, match="a dose is one step"):
        GateConfig(dose_every_steps=5, minimum_hold_steps=3)
    with pytest.raises(ParameterError, match="no limits on requests"):
        GateConfig(dose_every_steps=5, requests=RequestConfig(turn_s=2.0))
    with pytest.raises(ParameterError, match="wanted at least 2, like 10"):
        DosedGate(SupportGate(ByObservation(lambda _: 0.0), 0.0), 1)
