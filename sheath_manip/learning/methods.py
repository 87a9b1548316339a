"""The algorithms, each a choice of gate: who acts, and which states get the expert's label."""

from collections.abc import Callable
from dataclasses import dataclass

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.gates import (
    AlwaysExpert,
    HumanGate,
    Mixture,
    QueryFilter,
    RandomTakeover,
    SupportGate,
)
from sheath_manip.gates.human import Person
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.policies import FEATURE_EMBEDDINGS
from sheath_manip.policies.smile import as_first_member, expert_weight
from sheath_manip.protocols import Arrays, Gate

# The draft's, on binary features: its c = 0.01, taken as a share of them, since on distances
# themselves it would take exact copies of the training states alone for inside.
PAPER_BANDWIDTH = 0.01
PAPER_NU = 0.05
RELEASE_RATE = 0.5
"""LazyDAgger here hands back where half of the expert's own steps score lower"""


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
    """as the method changed it"""
    person: Person
    """who may take over"""


def _unchanged(plan: LearningPlan) -> LearningPlan:
    return plan


def _as_it_is(arrays: Arrays) -> Arrays:
    return arrays


@dataclass(frozen=True)
class Method:
    """One way to learn from an expert."""

    name: str
    summary: str
    gate: Callable[[RoundContext], Gate]
    follows: str | None = None
    """the method whose expert share this one is given, round by round"""
    plan: Callable[[LearningPlan], LearningPlan] = _unchanged
    """what it changes of the experiment's plan: signal, support, threshold; another policy only
    together with `begin`"""
    begin: Callable[[Arrays], Arrays] = _as_it_is
    """the learned state of its first policy, from that of the policy which all methods share"""
    looks: bool = True
    """whether its gate looks at the signal"""
    latest_only: bool = False
    """fit the policy to the last round's states alone, not to all so far"""


def _sheath(context: RoundContext) -> Gate:
    config, checkpoint = context.plan.gate, context.checkpoint
    return SupportGate(
        checkpoint.score,
        checkpoint.threshold,
        query=config.labels == "all",
        release_margin=checkpoint.release_margin + config.release_margin,
        quiet_steps=config.quiet_steps,
        minimum_hold_steps=config.minimum_hold_steps,
    )


def _own_labels(plan: LearningPlan) -> LearningPlan:
    return plan.changed(gate={"labels": "own"})


def _lazy(plan: LearningPlan) -> LearningPlan:
    return plan.changed(gate={"labels": "own", "release_rate": RELEASE_RATE})


def _thrifty(plan: LearningPlan) -> LearningPlan:
    threshold = {"rule": "budget", "recalibrate": True}
    return plan.changed(gate={"labels": "own", "threshold": threshold})


def _on_raw_features(plan: LearningPlan) -> LearningPlan:
    if plan.gate.embedding not in FEATURE_EMBEDDINGS:
        return plan
    return plan.changed(gate={"embedding": "features", "precedent_embedding": "features"})


def _paper(plan: LearningPlan) -> LearningPlan:
    support = {
        "name": "one-class-svm",
        "nu": PAPER_NU,
        "bandwidth_factor": PAPER_BANDWIDTH,
        "bandwidth_unit": "dimensions",
    }
    gate = {"signal": "support", "support": support, "threshold": {"rule": "boundary"}}
    return _on_raw_features(plan).changed(gate=gate)


def _smile(plan: LearningPlan) -> LearningPlan:
    settings = {
        "member": plan.policy.name,
        "member_settings": plan.policy.settings,
        "alpha": plan.schedule.alpha,
    }
    # A mixture has no convolutions to look through, nor weights of its own.
    mixed = _on_raw_features(plan).changed(policy={"name": "smile", "settings": settings})
    if plan.gate.embedding in FEATURE_EMBEDDINGS:
        return mixed
    looking = {"embedding": "pixels-whitened", "precedent_embedding": "pixels-whitened"}
    return mixed.changed(gate=looking)


METHODS = {
    method.name: method
    for method in (
        Method("cloning", "the expert drives, the policy only watches", lambda _: AlwaysExpert(),
               looks=False),
        # beta_1 = 1 are the demonstrations; after them the policy drives alone (Ross et al. 2011).
        Method("dagger", "the policy drives, every state is labelled", lambda _: Mixture(0.0),
               looks=False),
        Method(
            "dagger-beta",
            "the expert at random, with probability beta^i in round i, else the policy",
            lambda context: Mixture(context.plan.schedule.beta**context.round),
            looks=False,
        ),
        Method(
            "smile",
            "the policies of all rounds at random, and less and less the expert",
            lambda context: Mixture(expert_weight(context.plan.schedule.alpha, context.round)),
            plan=_smile,
            begin=as_first_member,
            looks=False,
            latest_only=True,
        ),
        Method("sheath", "the policy inside its support, the expert outside", _sheath),
        Method("sheath-own-labels", "SHEATH, learning from the expert's own steps", _sheath,
               plan=_own_labels),
        Method("sheath-plain", "SHEATH as in the draft: the support's own boundary", _sheath,
               plan=_paper),
        Method(
            "shiv",
            "the policy drives, states outside its support are labelled",
            lambda context: QueryFilter(context.checkpoint.score, context.checkpoint.threshold),
        ),
        Method(
            "hg-dagger",
            "the expert where a person says so, whose steps are learned from",
            lambda context: HumanGate(context.person),
            looks=False,
        ),
        Method(
            "lazy-dagger",
            "SHEATH with own labels, handing back well inside only",
            _sheath,
            plan=_lazy,
        ),
        Method(
            "thrifty-dagger",
            "SHEATH with own labels, at the threshold of an intervention budget",
            _sheath,
            plan=_thrifty,
        ),
        Method(
            "random-takeover",
            "the expert at random, with SHEATH's own share",
            lambda context: RandomTakeover(context.reference_share),
            follows="sheath",
            looks=False,
        ),
        Method(
            "random-own-labels",
            "the expert at random, with the share and the labels of SHEATH with own labels",
            lambda context: RandomTakeover(context.reference_share, query=False),
            follows="sheath-own-labels",
            looks=False,
        ),
    )
}  # fmt: skip


def method_named(name: str) -> Method:
    """The method; raises UnknownNameError."""
    if name not in METHODS:
        raise UnknownNameError("method", name, METHODS)
    return METHODS[name]
