"""SHIV's rule as a filter of queries: the policy always acts, labels are asked for where it is new.

Laskey et al. 2016, 'SHIV: Reducing supervisor burden in DAgger using support vectors' (ICRA).
"""

from dataclasses import replace

import numpy as np

from sheath_manip.gates.support import SupportGate
from sheath_manip.protocols import Judge
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason


class QueryFilter:
    """The policy acts; the expert is asked for a label where SHEATH would let it take over."""

    def __init__(self, judge: Judge, threshold: float) -> None:
        """Store who judges and the threshold below which a state is outside.

        A missing score is outside. ParameterError for a threshold that is not finite.
        """
        self.judge = judge
        self.threshold = threshold
        self._support = SupportGate(judge, threshold)

    def reset(self, rng: np.random.Generator) -> None:
        """Do nothing: there is nothing to forget."""
        self._support.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """The policy, labelled outside the support; the expert only where there is no proposal."""
        decision = self._support.decide(observation, proposal)
        outside = decision.actor is Actor.EXPERT
        acts = Actor.EXPERT if decision.reason is Reason.INVALID_PROPOSAL else Actor.POLICY
        return replace(decision, actor=acts, query=outside)
