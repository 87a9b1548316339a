"""What says whether the policy may be trusted with a state, by name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from sheath_manip.exceptions import UnknownNameError
from sheath_manip.learning.config import LearningPlan
from sheath_manip.policies import make_embedding
from sheath_manip.protocols import Embedding, Signal
from sheath_manip.signals.joined import JoinedSignal
from sheath_manip.signals.margin import MarginSignal
from sheath_manip.signals.near_precedent import NearPrecedentSignal
from sheath_manip.signals.precedent import PrecedentSignal
from sheath_manip.signals.support import SupportSignal
from sheath_manip.signals.trust import TrustSignal
from sheath_manip.support import make_support, support_hyperparameters


@dataclass(frozen=True)
class SignalChoice:
    """Which signal, made of what: enough to make it again before its learned state is loaded."""

    signal: str
    """name in SIGNALS"""
    embedding: str
    """of the support"""
    support: str
    precedent_embedding: str
    hyperparameters: Mapping[str, Any] = field(default_factory=dict)
    """of the support"""


def planned_signal(plan: LearningPlan) -> SignalChoice:
    """The choice that `plan` names."""
    hyperparameters = support_hyperparameters(plan)
    names = (plan.signal, plan.embedding, plan.support, plan.precedent_embedding)
    return SignalChoice(*names, hyperparameters)


JOINED_WEIGHTS = {"support": 1.0, "precedent": 2.0}
"""AUROC of costly mistakes on driving's tuning scenes, two training runs: .928 and .913, counting
alike .928 and .915; alone the support has .908 and .905, the precedent .918 and .900. Of windows
before failures .974 and .929, counting alike .972 and .928."""
TRUSTED_WEIGHTS = {"support": 1.0, "trust": 4.0, "margin": 2.0}
"""Of the platformer's fatal proposals on tuning stages those below a threshold under which 15, 17.5
and 20 % of all steps lie: .77, .81 and .85; without the margin .76, .79 and .80, trust alone .75,
.78 and .80, and `joined` .65, .69 and .70 (283 proposals, 30 stages)"""

MakeEmbedding = Callable[[str], Embedding]


def make_signal(choice: SignalChoice, embedding: MakeEmbedding = make_embedding) -> Signal:
    """A fresh signal, its embeddings made by name; UnknownNameError for one that is in no table."""
    if choice.signal not in SIGNALS:
        raise UnknownNameError("signal", choice.signal, SIGNALS)
    return SIGNALS[choice.signal](choice, embedding)


def _support(choice: SignalChoice, embedding: MakeEmbedding) -> SupportSignal:
    support = make_support(choice.support, **choice.hyperparameters)
    return SupportSignal(embedding(choice.embedding), support)


def _precedent(choice: SignalChoice, embedding: MakeEmbedding) -> PrecedentSignal:
    return PrecedentSignal(embedding(choice.precedent_embedding))


def _joined(choice: SignalChoice, embedding: MakeEmbedding) -> JoinedSignal:
    support, precedent = _support(choice, embedding), _precedent(choice, embedding)
    return JoinedSignal({"support": support, "precedent": precedent}, JOINED_WEIGHTS)


def _trust(choice: SignalChoice, embedding: MakeEmbedding) -> TrustSignal:
    return TrustSignal(embedding(choice.precedent_embedding))


def _trusted(choice: SignalChoice, embedding: MakeEmbedding) -> JoinedSignal:
    support, trust = _support(choice, embedding), _trust(choice, embedding)
    signals = {"support": support, "trust": trust, "margin": MarginSignal()}
    return JoinedSignal(signals, TRUSTED_WEIGHTS)


def _near_precedent(choice: SignalChoice, embedding: MakeEmbedding) -> NearPrecedentSignal:
    return NearPrecedentSignal(embedding(choice.precedent_embedding))


def _near_joined(choice: SignalChoice, embedding: MakeEmbedding) -> JoinedSignal:
    return JoinedSignal(
        {"support": _support(choice, embedding), "precedent": _near_precedent(choice, embedding)}
    )


SIGNALS: dict[str, Callable[[SignalChoice, MakeEmbedding], Signal]] = {
    "joined": _joined,
    "support": _support,
    "precedent": _precedent,
    "trust-joined": _trusted,
    "trust": _trust,
    # For continuous actions.
    "near-joined": _near_joined,
    "near-precedent": _near_precedent,
}
PRECEDENTS = {"joined": "precedent", "trust-joined": "trust", "near-joined": "near-precedent"}
"""by a joined signal, the one that is joined with the support"""
