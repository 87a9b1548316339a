"""What judges a proposal, and what decides who acts."""

from typing import Protocol

import numpy as np

from sheath_manip.types import GateDecision, Judgement, Observation, Proposal


class Judge(Protocol):
    """Says what it thinks of a proposal: a checkpoint does, by its signal."""

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        """Judge the proposal itself: nothing is asked of the policy again.

        What is to blame need not be found for a score that is not below `threshold`.
        """
        ...


class Gate(Protocol):
    """Decides at each step who acts and whether the expert is asked for a label."""

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode; all randomness comes from `rng`."""
        ...

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide for one step; `proposal` is None where the policy had nothing valid to say."""
        ...
