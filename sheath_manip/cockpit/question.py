"""What a person is asked about, as long as no step tells of it yet."""

from dataclasses import dataclass

from sheath_manip.types import Action, GateDecision, Observation


@dataclass(frozen=True, eq=False)
class Question:
    """A proposal that the gate does not let through, in its state."""

    observation: Observation
    proposed: Action | None
    """None where the policy had nothing valid to say"""
    decision: GateDecision
    """the gate's own, of before a person was thought of"""
