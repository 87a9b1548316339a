"""The one way from what was fitted to a gate: for training, running, benchmarks and pages alike."""

from collections.abc import Callable

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.gates.constant import AlwaysExpert
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.human import HumanGate, Nobody, Person
from sheath_manip.gates.mixture import Mixture
from sheath_manip.gates.query import QueryFilter
from sheath_manip.gates.support import SupportGate
from sheath_manip.gates.takeover import RandomTakeover
from sheath_manip.protocols import Gate


def make_gate(fitted: FittedGate, *, person: Person | None = None) -> Gate:
    """Return a fresh gate of the kind that `fitted.config` names; raises UnknownNameError.

    Args:
        fitted: settings, signal and threshold.
        person: who may take over where a gate leaves that to a person; nobody where it is None.
    """
    config = fitted.config
    if config.kind not in GATES:
        raise UnknownNameError("kind of gate", config.kind, GATES)
    return GATES[config.kind](fitted, person or Nobody())


def _support(fitted: FittedGate, person: Person) -> Gate:
    del person
    config = fitted.config
    return SupportGate(
        fitted,
        fitted.threshold,
        query=config.labels == "all",
        release_margin=fitted.release_margin + config.release_margin,
        quiet_steps=config.quiet_steps,
        minimum_hold_steps=config.minimum_hold_steps,
    )


GATES: dict[str, Callable[[FittedGate, Person], Gate]] = {
    "support": _support,
    "query-filter": lambda fitted, _: QueryFilter(fitted, fitted.threshold),
    "expert": lambda *_: AlwaysExpert(),
    "mixture": lambda fitted, _: Mixture(fitted.config.expert_share),
    "random-takeover": lambda fitted, _: RandomTakeover(
        fitted.config.expert_share, query=fitted.config.labels == "all"
    ),
    "human": lambda _, person: HumanGate(person),
}
"""Called with what was fitted, and the person who may take over."""
LOOKING = ("support", "query-filter")
"""the kinds that judge by a signal: for the others none is fitted"""
