"""What is compared: every embedding with every support estimator, and gates that have neither."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from sheath_manip.experiments.gates.plan import GatesPlan
from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, RandomTakeover
from sheath_manip.learning.config import LearningPlan
from sheath_manip.policies import embeddings_like
from sheath_manip.protocols import Gate
from sheath_manip.signals import PRECEDENTS
from sheath_manip.support import SUPPORTS

POLICY, EXPERT, RANDOM = "policy", "expert", "random-takeover"


@dataclass(frozen=True)
class Row:
    """One gate: what is fitted for it follows from its plan."""

    name: str
    """becomes a path below the run's directory"""
    plan: LearningPlan
    signals: tuple[str, ...] = ("support",)
    """what its score is made of"""
    main: bool = True
    """measured on more episodes than the rest of the grid"""


BASELINES: dict[str, Callable[[Sequence[float]], Sequence[Gate]]] = {
    POLICY: lambda _: [AlwaysPolicy(query=True)],
    EXPERT: lambda _: [AlwaysExpert()],
    RANDOM: lambda rates: [RandomTakeover(rate) for rate in rates],
}
"""gates that look at nothing, for each of the asked expert shares; they take part in the loop"""


def rows(plan: GatesPlan, learning: LearningPlan) -> list[Row]:
    """The most interesting first: the default, what differs from it in one part, then the rest."""
    signal = learning.gate.signal
    both = signal if signal in PRECEDENTS else "joined"
    joined = Row("joined", learning.changed(gate={"signal": both}), ("support", "precedent"))
    alone = learning.changed(gate={"signal": PRECEDENTS[both]})
    precedent = Row("precedent", alone, ("precedent",))
    return sorted([joined, precedent, *grid(plan, learning)], key=lambda row: not row.main)


def grid(plan: GatesPlan, learning: LearningPlan) -> list[Row]:
    """Every embedding, of images or of features as the default is, with every estimator."""
    default, estimator = learning.gate.embedding, learning.gate.support.name
    return [
        Row(
            f"{embedding}/{support}",
            learning.changed(
                gate={"signal": "support", "embedding": embedding, "support": {"name": support}}
            ),
            main=default == embedding or estimator == support,
        )
        for embedding in _after(default, embeddings_like(default), plan.embeddings)
        for support in _after(estimator, SUPPORTS, plan.supports)
    ]


def default_name(listed: Sequence[Row], learning: LearningPlan) -> str:
    """The row whose gate a learning run would take."""
    return next(row.name for row in listed if row.plan == learning)


def _after(default: str, table: Iterable[str], asked: Sequence[str] | None) -> list[str]:
    """The default, then the whole table, or what of it was asked for."""
    listed = [name for name in table if asked is None or name in asked]
    return list(dict.fromkeys([default, *listed]))
