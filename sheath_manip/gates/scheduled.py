"""Takeovers at set times: what a gate's choice of moments is held against."""

from collections.abc import Sequence

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason


class ScheduledTakeovers:
    """The expert acts in set steps of the episode, whatever the policy proposes there."""

    def __init__(self, turns: Sequence[tuple[int, int]], first_step: int = 0) -> None:
        """Store when the expert acts; ParameterError for a turn that is none.

        Args:
            turns: of the expert, (first step, number of steps) each, counted from the episode's
                start; they may overlap.
            first_step: of the episode, at which it is begun.
        """
        for turn in turns:
            if turn[0] < 0 or turn[1] < 1:
                raise ParameterError(f"turn is {turn}; wanted (first step, steps), like (20, 10)")
        self.turns = turns
        self.first_step = first_step
        self._expert = {step for start, count in turns for step in range(start, start + count)}
        self._step = first_step

    def reset(self, rng: np.random.Generator) -> None:
        """Begin at the first step again."""
        del rng
        self._step = self.first_step

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide by the schedule; the expert in any case where there is no proposal."""
        del observation
        step, self._step = self._step, self._step + 1
        if proposal is None:
            return GateDecision(Actor.EXPERT, True, Reason.INVALID_PROPOSAL)
        actor = Actor.EXPERT if step in self._expert else Actor.POLICY
        return GateDecision(actor, actor is Actor.EXPERT, Reason.FIXED)
