"""A proposal that is no action goes to the expert; who is missing or answers none is named."""

import numpy as np
import pytest

from sheath_manip.exceptions import AttemptError, ParameterError
from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, Mixture, SupportGate
from sheath_manip.types import (
    Actor,
    Proposal,
    Reason,
)
from tests.judging import always
from tests.rollout.corridor_episode import Saying, Scripted, run, still
from tests.toy import CHOICES


@pytest.mark.parametrize(
    "proposal",
    [[np.nan], [0.31], [-np.inf], [0.0, 0.0], 0.0, None, "left", [[0.0], [0.0, 0.1]]],
    ids=["nan", "out of bounds", "infinite", "too long", "no axis", "none", "text", "ragged"],
)
@pytest.mark.parametrize(
    "gate",
    [AlwaysPolicy(), Mixture(0.0), SupportGate(always(1.0), 0.0)],
    ids=lambda g: type(g).__name__,
)
def test_a_proposal_that_is_no_action_hands_the_step_to_the_expert(gate, proposal):
    policy = Saying(lambda index: proposal if index == 3 else CHOICES[1])
    expert = Scripted(lambda _: CHOICES[2])
    steps = run(gate, policy, expert).steps
    broken = steps[3]
    assert broken.proposed is None
    assert (broken.decision.actor, broken.decision.reason) == (
        Actor.EXPERT,
        Reason.INVALID_PROPOSAL,
    )
    np.testing.assert_array_equal(broken.executed, CHOICES[2])
    assert broken.labelled is broken.executed
    others = [step for index, step in enumerate(steps) if index != 3]
    assert {step.decision.actor for step in others} == {Actor.POLICY}


def test_the_loop_does_not_trust_a_gate_with_an_invalid_proposal():
    class Careless(AlwaysPolicy):
        def decide(self, observation, proposal):
            return super().decide(observation, proposal or Proposal(CHOICES[1][None]))

    expert = Scripted(lambda _: CHOICES[0])
    episode = run(Careless(), Saying(lambda _: [np.nan]), expert)
    assert {step.decision.reason for step in episode.steps} == {Reason.INVALID_PROPOSAL}
    assert {step.decision.actor for step in episode.steps} == {Actor.EXPERT}


@pytest.mark.parametrize(
    "gate", [AlwaysPolicy(), SupportGate(always(1.0), 0.0)], ids=lambda g: type(g).__name__
)
def test_a_gate_that_wants_a_policy_says_so(gate):
    with pytest.raises(ParameterError, match="wants a policy"):
        run(gate, None, Scripted(lambda _: CHOICES[1]))


def test_a_gate_that_wants_an_expert_says_so():
    for gate, policy in ((AlwaysExpert(), None), (AlwaysPolicy(query=True), still())):
        with pytest.raises(ParameterError, match="asks for the expert"):
            run(gate, policy)
    with pytest.raises(ParameterError, match="nobody can take over"):
        run(AlwaysPolicy(), Saying(lambda _: [np.nan]))


@pytest.mark.parametrize("answer", [[np.nan], [9.0], [0.0, 0.0]])
def test_an_experts_action_that_is_none_is_an_error(answer):
    with pytest.raises(AttemptError, match=r"expert broke down \(ActionError.*sidestep_m"):
        run(AlwaysExpert(), None, Scripted(lambda _: answer))
