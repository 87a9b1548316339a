"""A gate that goes on where the policy alone had come to: what it judged until then is recalled."""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Gate, Judge
from sheath_manip.types import (
    Actor,
    GateDecision,
    Judgement,
    Observation,
    Proposal,
    Step,
)


class Judging(Gate, Protocol):
    """A gate that asks a judge."""

    judge: Judge


def judging(gate: Any) -> Judging:
    """Return the gate that asks a judge: itself, or the one in it, or in that."""
    while not hasattr(gate, "judge"):
        gate = gate.gate
    return gate


class RecalledJudge:
    """Judges by recorded scores as long as there are some, then by itself."""

    def __init__(self, judge: Judge) -> None:
        self.judge_after = judge
        self._scores: list[float] = []

    def recall(self, scores: Sequence[float]) -> None:
        """Judge by (n,) `scores` first, the first one first."""
        self._scores = list(reversed(scores))

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        """Judge the proposal."""
        if self._scores:
            return Judgement(self._scores.pop())
        return self.judge_after.judge(observation, proposal, threshold)


class RecallingGate:
    """A gate at the first step that is not the policy's, in an episode the policy had alone."""

    def __init__(self, gate: Gate, steps: Sequence[Step], scores: NDArray[np.float64]) -> None:
        """Find where it takes over.

        Args:
            gate: whose judge is replaced, its own or that of the gate in it.
            steps: of the episode, T of them.
            scores: (T,) that the judge gives them.
        """
        asks = judging(gate)
        self._judge = RecalledJudge(asks.judge)
        asks.judge = self._judge
        self.gate = gate
        self.steps, self.scores = steps, scores
        self.first: int | None = None
        """the step in which it takes over; None where it never does"""
        self.reset(np.random.default_rng(0))
        for index, step in enumerate(steps):
            if self._decide_again(step).actor is not Actor.POLICY:
                self.first = index
                break

    def reset(self, rng: np.random.Generator) -> None:
        """Begin, and live through the steps before the first takeover."""
        self.gate.reset(rng)
        self._judge.recall(list(map(float, self.scores)))
        for step in self.steps[: self.first or 0]:
            self._decide_again(step)
        if self.first is not None:
            self._judge.recall([])

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does."""
        return self.gate.decide(observation, proposal)

    def _decide_again(self, step: Step) -> GateDecision:
        proposal = None if step.proposed is None else Proposal(step.proposed[None])
        return self.gate.decide(step.observation, proposal)
