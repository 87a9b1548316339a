"""What says whether the policy may be trusted with a state, by name."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from sheath_manip.policies import make_embedding
from sheath_manip.policies.shared import shared_by_name
from sheath_manip.protocols import Embedding, Signal
from sheath_manip.registry import Registry


@dataclass(frozen=True)
class SignalChoice:
    """A signal and what it is made of: enough to make it before its learned state is loaded."""

    signal: str
    """name in SIGNALS"""
    embedding: str
    """of the support"""
    support: str
    precedent_embedding: str
    hyperparameters: Mapping[str, Any] = field(default_factory=dict)
    """of the support"""


MakeEmbedding = Callable[[str], Embedding]
_RECIPES = "sheath_manip.signals.recipes"

SIGNALS: Registry[Callable[[SignalChoice, MakeEmbedding], Signal]] = Registry(
    "signal",
    "sheath.signals",
    {
        "joined": f"{_RECIPES}:joined",
        "support": f"{_RECIPES}:support",
        "precedent": f"{_RECIPES}:precedent",
        "trust-joined": f"{_RECIPES}:trust_joined",
        "trust": f"{_RECIPES}:trust",
        # For continuous actions.
        "near-joined": f"{_RECIPES}:near_joined",
        "near-precedent": f"{_RECIPES}:near_precedent",
    },
)
"""Called with the choice and with what makes an embedding by name."""
PRECEDENTS = {"joined": "precedent", "trust-joined": "trust", "near-joined": "near-precedent"}
"""by a joined signal, the one that is joined with the support"""


def make_signal(choice: SignalChoice, embedding: MakeEmbedding = make_embedding) -> Signal:
    """A fresh signal, its embeddings made by name; UnknownNameError for one that is in no table."""
    return SIGNALS[choice.signal](choice, shared_by_name(embedding))
