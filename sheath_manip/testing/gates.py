"""What every gate must do."""

from collections.abc import Callable, Sequence

import numpy as np

from sheath_manip.protocols import Gate
from sheath_manip.testing.sentences import wants, wants_a
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason


def check_gate(
    make: Callable[[], Gate], observations: Sequence[Observation], proposals: Sequence[Proposal]
) -> None:
    """Check a gate on steps that follow each other; `make` gives a fresh one.

    Args:
        make: called without arguments.
        observations: of one episode.
        proposals: what the policy proposed in each.
    """

    def run(gate: Gate) -> list[GateDecision]:
        gate.reset(np.random.default_rng(0))
        return [gate.decide(*step) for step in zip(observations, proposals, strict=True)]

    gate = make()
    decisions = run(gate)
    for decision in decisions:
        wants_a(GateDecision, decision, "decide")
        wants(isinstance(decision.actor, Actor), f"{decision.actor!r} is no Actor")
        wants(isinstance(decision.reason, Reason), f"{decision.reason!r} is no Reason")
        wants(isinstance(decision.query, bool), f"query is {decision.query!r}; wanted a bool")
        wants(
            decision.query or decision.actor is not Actor.EXPERT,
            "where the expert acts it must be asked for its label",
        )
    first = [_key(each) for each in decisions]
    gate.decide(observations[0], None)
    wants(
        [_key(each) for each in run(gate)] == first,
        "reset must forget the last episode, and all that is drawn must come from its rng",
    )
    gate.reset(np.random.default_rng(0))
    for observation in observations[:3]:
        decision = gate.decide(observation, None)
        wants(
            decision.actor is not Actor.POLICY,
            "the policy must not act where it has proposed nothing valid",
        )


def _key(decision: GateDecision) -> tuple[str, bool, str, str]:
    return str(decision.actor), decision.query, str(decision.reason), repr(decision.score)
