"""The algorithms, each a choice of gate: who acts, and which states get the expert's label."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.blocks import BlocksConfig
from sheath_manip.gates.making import GATES
from sheath_manip.learning.config import LearningPlan, Schedule
from sheath_manip.metrics import EpisodeRecord, expert_share
from sheath_manip.policies import FEATURE_EMBEDDINGS
from sheath_manip.policies.smile import as_first_member, expert_weight
from sheath_manip.protocols import Arrays
from sheath_manip.registry import Registry

# The draft's, on binary features: its c = 0.01, taken as a share of them, since on distances
# themselves it would take exact copies of the training states alone for inside.
PAPER_BANDWIDTH = 0.01
PAPER_NU = 0.05
RELEASE_RATE = 0.5
"""LazyDAgger here hands back where half of the expert's own steps score lower"""


def equal_share(executed: Sequence[EpisodeRecord]) -> Mapping[str, Any]:
    """Return the setting of a gate that gives the expert the share of the steps of `executed`."""
    return {"expert_share": expert_share(executed)}


def equal_takeovers(executed: Sequence[EpisodeRecord]) -> Mapping[str, Any]:
    """Return the setting of a gate that takes over as often and as long as in `executed`.

    Raises ParameterError for results of before the lengths of takeovers were kept.
    """
    if any(len(each.turns) != each.interventions for each in executed):
        raise ParameterError(
            "the rounds to be held against do not say how long takeovers were; wanted ones that "
            "this version ran: begin the run afresh"
        )
    by_policy = sum(each.steps - each.expert_steps - each.hold_steps for each in executed)
    blocks = BlocksConfig.like([each.turns for each in executed], by_policy)
    return {"blocks": asdict(blocks)}


def _unchanged(plan: LearningPlan) -> LearningPlan:
    return plan


def _as_it_is(arrays: Arrays) -> Arrays:
    return arrays


@dataclass(frozen=True)
class Method:
    """One way to learn from an expert."""

    name: str
    summary: str
    plan: Callable[[LearningPlan], LearningPlan] = _unchanged
    """what it changes of the experiment's plan: the gate's kind, signal, threshold and labels;
    another policy only together with `initial_policy`"""
    initial_policy: Callable[[Arrays], Arrays] = _as_it_is
    """the learned state of its first policy, from that of the policy which all methods share"""
    burden_from: str | None = None
    """the method whose burden this one is given, round by round"""
    burden: Callable[[Sequence[EpisodeRecord]], Mapping[str, Any]] = equal_share
    """the gate's settings that give it, from the episodes that the other method ran in the round"""
    share: Callable[[Schedule, int], float] | None = None
    """the expert's share in a round, counted from 1, where a schedule says so"""
    latest_only: bool = False
    """fit the policy to the last round's states alone, not to all so far"""

    def uses_signal(self, plan: LearningPlan) -> bool:
        """Tell whether its gate judges by a signal, under the experiment's `plan`."""
        return GATES[self.plan(plan).gate.kind].looks


def _gate(**settings: object) -> Callable[[LearningPlan], LearningPlan]:
    return lambda plan: plan.changed(gate=settings)


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
    gate = {
        "signal": "support",
        "support": support,
        "threshold": {"rule": "boundary"},
        "stuck_steps": 0,
    }
    return _on_raw_features(plan).changed(gate=gate)


def _smile(plan: LearningPlan) -> LearningPlan:
    settings = {
        "member": plan.policy.name,
        "member_settings": plan.policy.settings,
        "alpha": plan.schedule.alpha,
    }
    mixed = plan.changed(policy={"name": "smile", "settings": settings})
    return mixed.changed(gate={"kind": "mixture"})


CLONING = Method(
    "cloning",
    "the expert drives, the policy only watches",
    _gate(kind="expert"),
)
# beta_1 = 1 are the demonstrations; after them the policy drives alone (Ross et al. 2011).
DAGGER = Method(
    "dagger",
    "the policy drives, every state is labelled",
    _gate(kind="mixture"),
)
DAGGER_BETA = Method(
    "dagger-beta",
    "the expert at random, with probability beta^i in round i, else the policy",
    _gate(kind="mixture"),
    share=lambda schedule, number: schedule.beta**number,
)
SMILE = Method(
    "smile",
    "the policies of all rounds at random, and less and less the expert",
    _smile,
    initial_policy=as_first_member,
    share=lambda schedule, number: expert_weight(schedule.alpha, number),
    latest_only=True,
)
SHEATH = Method("sheath", "the policy inside its support, the expert outside")
SHEATH_OWN_LABELS = Method(
    "sheath-own-labels",
    "SHEATH, learning from the expert's own steps",
    _gate(labels="own"),
)
SHEATH_PLAIN = Method(
    "sheath-plain",
    "SHEATH as in the draft: the support's own boundary",
    _paper,
)
SHIV = Method(
    "shiv",
    "the policy drives, states outside its support are labelled",
    _gate(kind="query-filter"),
)
HG_DAGGER = Method(
    "hg-dagger",
    "the expert where a person says so, whose steps are learned from",
    _gate(kind="human"),
)
LAZY_DAGGER = Method(
    "lazy-dagger",
    "SHEATH with own labels, handing back well inside only",
    _gate(labels="own", release_rate=RELEASE_RATE),
)
THRIFTY_DAGGER = Method(
    "thrifty-dagger",
    "SHEATH with own labels, at the threshold of an intervention budget",
    _gate(labels="own", threshold={"rule": "budget", "recalibrate": True}),
)
RANDOM_TAKEOVER = Method(
    "random-takeover",
    "the expert at random, with SHEATH's own share",
    _gate(kind="random-takeover"),
    burden_from="sheath",
)
RANDOM_OWN_LABELS = Method(
    "random-own-labels",
    "the expert at random, with the share and the labels of SHEATH with own labels",
    _gate(kind="random-takeover", labels="own"),
    burden_from="sheath-own-labels",
)
RANDOM_BLOCKS = Method(
    "random-blocks",
    "the expert in blocks at random, as many and as long as SHEATH's takeovers",
    _gate(kind="random-blocks"),
    burden_from="sheath",
    burden=equal_takeovers,
)

METHODS: Registry[Method] = Registry(
    "method",
    "sheath.methods",
    {
        "cloning": f"{__name__}:CLONING",
        "dagger": f"{__name__}:DAGGER",
        "dagger-beta": f"{__name__}:DAGGER_BETA",
        "smile": f"{__name__}:SMILE",
        "sheath": f"{__name__}:SHEATH",
        "sheath-own-labels": f"{__name__}:SHEATH_OWN_LABELS",
        "sheath-plain": f"{__name__}:SHEATH_PLAIN",
        "shiv": f"{__name__}:SHIV",
        "hg-dagger": f"{__name__}:HG_DAGGER",
        "lazy-dagger": f"{__name__}:LAZY_DAGGER",
        "thrifty-dagger": f"{__name__}:THRIFTY_DAGGER",
        "random-takeover": f"{__name__}:RANDOM_TAKEOVER",
        "random-own-labels": f"{__name__}:RANDOM_OWN_LABELS",
        "random-blocks": f"{__name__}:RANDOM_BLOCKS",
    },
    of=Method,
)


def method_named(name: str) -> Method:
    """Return the method; raises UnknownNameError."""
    return METHODS[name]
