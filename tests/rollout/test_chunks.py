"""A policy that draws several actions at once: what the gate judges of them is what is executed."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.gates import SupportGate
from sheath_manip.types import (
    Action,
    Actor,
    Judgement,
    Observation,
    Observations,
    Proposal,
    Reason,
)
from tests.rollout.corridor_episode import Scripted, run
from tests.toy import CHOICES, Corridor


class InChunks:
    """Draws the next three actions at once, and plays them: asked anew it would say otherwise."""

    def reset(self, rng: np.random.Generator) -> None:
        self.rng = rng
        self.left = np.zeros((0, 1), np.float32)

    def propose(self, observations: Observations) -> Proposal:
        assert len(observations) == 1
        if not len(self.left):
            self.left = CHOICES[self.rng.integers(3, size=3)]
        chunk, self.left = self.left, self.left[1:]
        return Proposal(chunk[None])


class Remembering:
    """Judges by the side to which the proposal goes, and remembers what it was shown."""

    def __init__(self) -> None:
        self.judged: list[tuple[Observation, Action]] = []

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        del threshold
        self.judged.append((observation, proposal.now[0]))
        return Judgement(float(proposal.now[0, 0]))


@pytest.mark.parametrize("threshold", [-9.0, 0.0])
def test_what_the_gate_judges_of_a_chunk_is_what_is_executed(threshold):
    judge = Remembering()
    expert = Scripted(lambda _: CHOICES[1])
    environment = Corridor(steps=60)
    judged_anew = 0
    for seed in range(4):
        judge.judged.clear()
        gate = SupportGate(judge, threshold)
        steps = run(gate, InChunks(), expert, environment=environment, seed=seed).steps
        assert len(judge.judged) == len(steps) >= 3
        for (observation, judged), step in zip(judge.judged, steps, strict=True):
            assert observation is step.observation
            np.testing.assert_array_equal(judged, step.proposed)
            inside = float(judged[0]) >= threshold
            assert step.decision.actor is (Actor.POLICY if inside else Actor.EXPERT)
            if inside:
                np.testing.assert_array_equal(step.executed, judged)
            judged_anew += not inside
    assert (judged_anew > 0) == (threshold == 0.0)


def test_the_action_judged_is_the_validated_one_also_of_a_chunk_in_another_type():
    class Doubles(InChunks):
        def propose(self, observations: Observations) -> Proposal:
            proposal = super().propose(observations)
            return replace(proposal, actions=np.asarray(proposal.actions, np.float64))

    judge = Remembering()
    steps = run(SupportGate(judge, -9.0, query=False), Doubles()).steps
    for (_, judged), step in zip(judge.judged, steps, strict=True):
        assert judged.dtype == step.executed.dtype == np.float32
        np.testing.assert_array_equal(step.executed, judged)


def test_a_chunk_whose_present_action_is_none_hands_the_step_to_the_expert():
    class Broken(InChunks):
        def propose(self, observations: Observations) -> Proposal:
            actions = super().propose(observations).actions.copy()
            actions[0, 0] = np.nan
            return Proposal(actions)

    steps = run(SupportGate(Remembering(), -9.0), Broken(), Scripted(lambda _: CHOICES[1])).steps
    assert {step.decision.reason for step in steps} == {Reason.INVALID_PROPOSAL}
    assert {step.decision.actor for step in steps} == {Actor.EXPERT}


class Planning(InChunks):
    """Tells how often it has heard that its plan is void."""

    def reset(self, rng: np.random.Generator) -> None:
        super().reset(rng)
        self.heard = 0

    def replan(self) -> None:
        self.heard += 1
        self.left = self.left[:0]


def test_a_plan_is_void_once_somebody_else_has_acted():
    policy, judge = Planning(), Remembering()
    expert = Scripted(lambda _: CHOICES[1])
    steps = run(
        SupportGate(judge, 0.0), policy, expert, environment=Corridor(steps=60), seed=1
    ).steps
    others = [step.decision.actor is not Actor.POLICY for step in steps]
    assert 0 < sum(others[:-1]) == policy.heard
