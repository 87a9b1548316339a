"""The algorithms, each a choice of gate: who acts, and which states get the expert's label."""

from collections.abc import Callable
from dataclasses import dataclass

from sheath_manip.checkpoint import Checkpoint
from sheath_manip.exceptions import UnknownNameError
from sheath_manip.gates.constant import AlwaysExpert
from sheath_manip.gates.mixture import Mixture
from sheath_manip.gates.support import SupportGate
from sheath_manip.gates.takeover import RandomTakeover
from sheath_manip.plan import LearningPlan
from sheath_manip.protocols import Gate


@dataclass(frozen=True)
class RoundContext:
    """What a method may use to make its gate for one round."""

    checkpoint: Checkpoint
    """fitted after the round before"""
    round: int
    """from 1"""
    reference_share: float
    """the expert's share, in this round, of the method to compare with (`Method.follows`)"""
    plan: LearningPlan


@dataclass(frozen=True)
class Method:
    """One way to learn from an expert."""

    name: str
    summary: str
    gate: Callable[[RoundContext], Gate]
    follows: str | None = None
    """the method whose expert share this one is given, round by round"""


def _sheath(context: RoundContext) -> Gate:
    return SupportGate(
        context.checkpoint.score,
        context.checkpoint.threshold,
        release_margin=context.plan.release_margin,
        quiet_steps=context.plan.quiet_steps,
        minimum_hold_steps=context.plan.minimum_hold_steps,
    )


METHODS = {
    method.name: method
    for method in (
        Method("cloning", "the expert drives, the policy only watches", lambda _: AlwaysExpert()),
        # beta_1 = 1 are the demonstrations; after them the policy drives alone (Ross et al. 2011).
        Method("dagger", "the policy drives, every state is labelled", lambda _: Mixture(0.0)),
        Method("sheath", "the policy inside its support, the expert outside", _sheath),
        Method(
            "random-takeover",
            "the expert at random, with SHEATH's own share",
            lambda context: RandomTakeover(context.reference_share),
            follows="sheath",
        ),
    )
}


def method_named(name: str) -> Method:
    """The method; raises UnknownNameError."""
    if name not in METHODS:
        raise UnknownNameError("method", name, METHODS)
    return METHODS[name]
