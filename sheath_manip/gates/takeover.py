"""Random takeover: the baseline that tells what a gate's choice of moments is worth.

Given the expert's share that a support gate had, it takes over as often, but at random steps.
"""

from dataclasses import replace

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.mixture import Mixture
from sheath_manip.types import Actor, GateDecision, Observation, Proposal


class RandomTakeover:
    """The expert acts in an expected share of the steps, drawn independently."""

    def __init__(self, share: float, query: bool = True) -> None:
        """Store the expert's share of the steps, in 0..1, and whether it labels the others too.

        ParameterError for a share outside its range.
        """
        if not 0 <= share <= 1:
            raise ParameterError(f"share is {share}; wanted the expert's share in 0..1, like 0.3")
        self.share = share
        self.query = query
        self._mixture = Mixture(share)

    def reset(self, rng: np.random.Generator) -> None:
        """Draw from `rng` from now on."""
        self._mixture.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide by one draw a step; the expert in any case where there is no proposal."""
        decision = self._mixture.decide(observation, proposal)
        query = self.query or decision.actor is Actor.EXPERT
        return replace(decision, query=query)
