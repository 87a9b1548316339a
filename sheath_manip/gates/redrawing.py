"""A gate for policies that draw: at the start of an episode they get their randomness with it."""

from typing import Protocol, runtime_checkable

import numpy as np

from sheath_manip.protocols import Gate, Proposer
from sheath_manip.types import Action, GateDecision, Observation


@runtime_checkable
class DrawingPolicy(Protocol):
    """A policy whose actions are drawn."""

    def draw_from(self, rng: np.random.Generator) -> None:
        """Take all randomness from `rng` from now on."""
        ...


class Redrawing:
    """Decides as the gate it is given, and seeds the policy anew where that one is reset.

    So an episode depends on its own seeds only, and a run that was stopped between two episodes
    continues to the same result.
    """

    def __init__(self, gate: Gate, policy: DrawingPolicy) -> None:
        self.gate = gate
        self.policy = policy

    def reset(self, rng: np.random.Generator) -> None:
        """The policy's draws are apart from the gate's, which stay what they were without it."""
        self.policy.draw_from(rng.spawn(1)[0])
        self.gate.reset(rng)

    def decide(self, observation: Observation, proposed: Action | None) -> GateDecision:
        """As the gate decides."""
        return self.gate.decide(observation, proposed)


def redrawing(gate: Gate, policy: Proposer | None) -> Gate:
    """`gate`, made to seed the policy too where that one draws."""
    return Redrawing(gate, policy) if isinstance(policy, DrawingPolicy) else gate
