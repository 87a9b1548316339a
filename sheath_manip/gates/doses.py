"""A gate whose expert acts in doses while it alarms: a step now and then, the policy in between."""

from dataclasses import replace

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Gate
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason

ALARMS = (Reason.OUTSIDE, Reason.RISK)
"""for which a dose may do; where there is no score or no action it does not"""


class DosedGate:
    """Another gate, of whose alarms the expert takes one step in so many.

    A policy that errs a little everywhere is kept on its way by single steps of the expert, and a
    threshold so high that most states alarm would else leave it none of the steps. The policy acts
    in states that are not trusted, so this is for programs as experts, where a fault costs little.
    """

    def __init__(self, gate: Gate, every_steps: int) -> None:
        """Store the gate that alarms, and how many steps there are from one dose to the next.

        ParameterError for fewer than 2, which would be all.
        """
        if every_steps < 2:
            raise ParameterError(f"every_steps is {every_steps}; wanted at least 2, like 10")
        self.gate = gate
        self.every_steps = every_steps
        self._left = 0

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode: the first alarm is a dose."""
        self.gate.reset(rng)
        self._left = 0

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does, but for the policy in an alarm soon after a dose."""
        decision = self.gate.decide(observation, proposal)
        self._left = max(0, self._left - 1)
        if decision.actor is Actor.POLICY:
            return decision
        if self._left and decision.reason in ALARMS:
            return replace(decision, actor=Actor.POLICY, query=False, reason=Reason.FIXED)
        self._left = self.every_steps
        return decision
