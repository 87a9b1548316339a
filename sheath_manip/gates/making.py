"""The one way from what was fitted to a gate: for training, running, benchmarks and pages alike."""

from collections.abc import Callable
from dataclasses import dataclass

from sheath_manip.gates.blocks import RandomBlocks
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.constant import AlwaysExpert
from sheath_manip.gates.doses import DosedGate
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.human import HumanGate, Nobody, Person
from sheath_manip.gates.labels import label_rules
from sheath_manip.gates.labels.gate import LabellingGate
from sheath_manip.gates.mixture import Mixture
from sheath_manip.gates.patient import PatientGate
from sheath_manip.gates.progress import ProgressGate
from sheath_manip.gates.query import QueryFilter
from sheath_manip.gates.support import SupportGate
from sheath_manip.gates.takeover import RandomTakeover
from sheath_manip.protocols import Gate
from sheath_manip.registry import Registry


@dataclass(frozen=True)
class GateKind:
    """One kind of gate: how it is made, and what must be fitted for it."""

    make: Callable[[FittedGate, Person], Gate]
    """from what was fitted, and the person who may take over"""
    looks: bool = False
    """whether it judges by a signal: for others none is fitted"""


def make_gate(fitted: FittedGate, *, person: Person | None = None) -> Gate:
    """Return a fresh gate of the kind that `fitted.config` names; raises UnknownNameError.

    Args:
        fitted: settings, signal and threshold.
        person: who may take over where a gate leaves that to a person; nobody where it is None.
    """
    return GATES[fitted.config.kind].make(fitted, person or Nobody())


def _support(fitted: FittedGate, person: Person) -> Gate:
    del person
    config = fitted.config
    gate: Gate = SupportGate(
        fitted,
        fitted.threshold,
        query=False,
        release_margin=fitted.release_margin + config.release_margin,
        quiet_steps=config.quiet_steps,
        minimum_hold_steps=config.minimum_hold_steps,
    )
    if config.dose_every_steps:
        gate = DosedGate(gate, config.dose_every_steps)
    if fitted.progress is not None:
        gate = ProgressGate(gate, fitted.progress)
    if config.requests.limits:
        gate = PatientGate(gate, config.requests)
    return _labelled(gate, config)


def _random_takeover(fitted: FittedGate, person: Person) -> Gate:
    del person
    return _labelled(RandomTakeover(fitted.config.expert_share, query=False), fitted.config)


def _random_blocks(fitted: FittedGate, person: Person) -> Gate:
    del person
    return _labelled(RandomBlocks(fitted.config.blocks), fitted.config)


def _labelled(gate: Gate, config: GateConfig) -> Gate:
    """The gate, with labels of the policy's steps by the rules of `config`."""
    makers = [rule.make for rule in label_rules(config.labels) if rule.make is not None]
    rules = [make(config.labelling) for make in makers]
    return LabellingGate(gate, rules, config.labelling.an_episode) if rules else gate


SUPPORT = GateKind(_support, looks=True)
QUERY_FILTER = GateKind(lambda fitted, _: QueryFilter(fitted, fitted.threshold), looks=True)
EXPERT = GateKind(lambda *_: AlwaysExpert())
MIXTURE = GateKind(lambda fitted, _: Mixture(fitted.config.expert_share))
RANDOM_TAKEOVER = GateKind(_random_takeover)
RANDOM_BLOCKS = GateKind(_random_blocks)
HUMAN = GateKind(lambda _, person: HumanGate(person))

GATES: Registry[GateKind] = Registry(
    "kind of gate",
    "sheath.gates",
    {
        "support": f"{__name__}:SUPPORT",
        "query-filter": f"{__name__}:QUERY_FILTER",
        "expert": f"{__name__}:EXPERT",
        "mixture": f"{__name__}:MIXTURE",
        "random-takeover": f"{__name__}:RANDOM_TAKEOVER",
        "random-blocks": f"{__name__}:RANDOM_BLOCKS",
        "human": f"{__name__}:HUMAN",
    },
    of=GateKind,
)
