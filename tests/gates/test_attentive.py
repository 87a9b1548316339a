"""HG-DAgger's person: no machine calls him, so he sees it late, and stays until all is well."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import AttentivePerson, HumanGate
from sheath_manip.rollout.simulated_operator import OperatorConfig, SimulatedOperator
from sheath_manip.types import Actor, Observation, Proposal, Reason
from tests.contracts.test_gates import RATE_HZ, SPEC, Doubter, watching

PROPOSED = Proposal(np.zeros((1, 1), np.float32))
QUICK = OperatorConfig(reaction_s=0.3, reaction_spread_s=0.0, attention_s=0.0)


def decided(person: AttentivePerson, wishes: list[float]) -> list:
    """What the gate says where the expert wishes that, and the policy proposes 0."""
    gate = HumanGate(person)
    gate.reset(np.random.default_rng(0))
    return [
        gate.decide(Observation({}, np.array([wish], np.float32), step / RATE_HZ), PROPOSED)
        for step, wish in enumerate(wishes)
    ]


def letters(decisions: list) -> str:
    return "".join(each.actor.value[0] for each in decisions)


def test_he_takes_over_after_his_reaction_and_hands_back_after_it():
    decisions = decided(watching(QUICK), [0.0, *[2.0] * 6, *[0.0] * 6])
    assert letters(decisions) == "pppp" + "eee" + "eee" + "ppp"
    assert {each.reason for each in decisions} == {Reason.PERSON}
    # HG-DAgger: what he drives himself is learned from, and nothing else.
    assert all(each.query is (each.actor is Actor.EXPERT) for each in decisions)


def test_what_the_task_counts_as_the_same_he_lets_pass():
    assert letters(decided(watching(QUICK), [0.9] * 10)) == "p" * 10
    assert "e" in letters(decided(watching(QUICK), [1.1] * 10))


def test_one_odd_action_is_no_reason():
    person = AttentivePerson(Doubter(), SPEC, SimulatedOperator(QUICK), while_s=0.5)
    odd = [2.0 if step % 4 == 0 else 0.0 for step in range(40)]
    assert letters(decided(person, odd)) == "p" * 40
    often = [2.0 if step % 4 else 0.0 for step in range(40)]
    assert letters(decided(person, often)).count("e") > 30


def test_each_episode_begins_with_the_policy():
    person = watching(QUICK)
    decided(person, [2.0] * 8)
    assert letters(decided(person, [0.0] * 4)) == "pppp"


def test_a_while_below_zero_is_refused():
    with pytest.raises(ParameterError, match="while_s is -1"):
        AttentivePerson(Doubter(), SPEC, SimulatedOperator(QUICK), while_s=-1.0)
