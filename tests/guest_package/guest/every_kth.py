"""A gate that gives the expert every k-th step, and the method that goes with it."""

import numpy as np

from sheath_manip.gates.making import GateKind
from sheath_manip.learning.methods import Method
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason


class EveryKth:
    """The expert acts, and labels, at every k-th step and where there is no proposal."""

    def __init__(self, k: int) -> None:
        self.k, self._step = k, 0

    def reset(self, rng: np.random.Generator) -> None:
        """Count from the start."""
        del rng
        self._step = 0

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Count one step."""
        del observation
        self._step += 1
        expert = proposal is None or self._step % self.k == 0
        return GateDecision(Actor.EXPERT if expert else Actor.POLICY, expert, Reason.FIXED)


EVERY_KTH = GateKind(lambda fitted, _: EveryKth(round(1 / max(fitted.config.expert_share, 0.01))))
METHOD = Method(
    "every-kth",
    "the expert at every fourth step",
    lambda plan: plan.changed(gate={"kind": "every-kth", "expert_share": 0.25, "labels": "own"}),
)
