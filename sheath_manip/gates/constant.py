"""Gates that always choose the same: demonstrations, evaluation, DAgger without its mixture."""

import numpy as np

from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason


class AlwaysExpert:
    """The expert acts at every step: demonstrations and behaviour cloning."""

    def reset(self, rng: np.random.Generator) -> None:
        """Do nothing: there is nothing to forget."""

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Always the expert, always labelled."""
        del observation, proposal
        return GateDecision(Actor.EXPERT, True, Reason.FIXED)


class AlwaysPolicy:
    """The policy acts at every step at which it has something valid to say."""

    def __init__(self, query: bool = False) -> None:
        """Store whether the expert labels every state (DAgger) or none (evaluation)."""
        self.query = query

    def reset(self, rng: np.random.Generator) -> None:
        """Do nothing: there is nothing to forget."""

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Always the policy; the expert only where there is no proposal."""
        del observation
        if proposal is None:
            return GateDecision(Actor.EXPERT, True, Reason.INVALID_PROPOSAL)
        return GateDecision(Actor.POLICY, self.query, Reason.FIXED)
