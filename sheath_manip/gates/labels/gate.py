"""Another gate, some of whose policy's steps the expert labels as well."""

from collections.abc import Sequence

import numpy as np

from sheath_manip.gates.labels import AsksForLabels
from sheath_manip.protocols import Gate
from sheath_manip.types import Actor, GateDecision, Observation, Proposal


class LabellingGate:
    """Decides as another gate does, and asks for labels by rules until an episode has enough."""

    def __init__(self, gate: Gate, rules: Sequence[AsksForLabels], an_episode: int = 0) -> None:
        """Store the gate that says who acts, and what asks; with 0 there is no limit."""
        self.gate = gate
        self.rules = rules
        self.an_episode = an_episode
        self._asked = 0

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode, with draws for each rule apart from the gate's."""
        self._asked = 0
        for rule, draws in zip(self.rules, rng.spawn(len(self.rules)), strict=True):
            rule.reset(draws)
        self.gate.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does; ask for a label where a rule wants one of the policy's steps."""
        decision = self.gate.decide(observation, proposal)
        if decision.actor is not Actor.POLICY or decision.query:
            return decision
        # All of them are asked, so that the draws of one do not depend on what another says.
        wanted = [rule.asks(observation, decision) for rule in self.rules]
        if not any(wanted) or (self.an_episode and self._asked >= self.an_episode):
            return decision
        self._asked += 1
        return _with_label(decision)


def _with_label(decision: GateDecision) -> GateDecision:
    """Return the decision with a label asked for.

    Often in every step, and `dataclasses.replace` takes four times as long.
    """
    return GateDecision(
        decision.actor,
        True,
        decision.reason,
        decision.score,
        decision.threshold,
        decision.broken,
        decision.waited_s,
        decision.signals,
    )
