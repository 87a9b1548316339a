"""DAgger's mixture of expert and policy.

Ross, Gordon & Bagnell 2011, 'A reduction of imitation learning and structured prediction to
no-regret online learning', Algorithm 3.1: pi_i = beta_i * expert + (1 - beta_i) * policy.
"""

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason


class Mixture:
    """The expert acts with probability beta, drawn anew at each step; every state is labelled."""

    def __init__(self, beta: float) -> None:
        """Store beta, in 0..1; ParameterError outside."""
        if not 0 <= beta <= 1:
            raise ParameterError(f"beta is {beta}; wanted a probability in 0..1, like 0.5")
        self.beta = beta
        self._rng = np.random.default_rng(0)

    def reset(self, rng: np.random.Generator) -> None:
        """Draw from `rng` from now on."""
        self._rng = rng

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide by one draw a step; the expert in any case where there is no proposal."""
        del observation
        # Drawn first, so that an invalid proposal does not shift the draws that follow.
        drawn = self._rng.random() < self.beta
        if proposal is None:
            return GateDecision(Actor.EXPERT, True, Reason.INVALID_PROPOSAL)
        return GateDecision(Actor.EXPERT if drawn else Actor.POLICY, True, Reason.DRAWN)
