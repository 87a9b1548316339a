"""Which states get a label beside those in which the expert acts: rules by name, one a file.

The expert's own steps cost no further attention, and are labelled under every rule. A rule says of
the policy's steps which of them the expert is asked about as well; `drawn+before-failure` are two
rules, and a step is labelled where one of them wants it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.labels.config import LabellingConfig
from sheath_manip.registry import Registry
from sheath_manip.types import GateDecision, Observation

AND = "+"
"""between the names of several rules"""


class AsksForLabels(Protocol):
    """Says at each of the policy's steps whether the expert is asked for a label."""

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode, and draw from `rng` from now on."""
        ...

    def asks(self, observation: Observation, decision: GateDecision) -> bool:
        """Return whether this step, in which the policy acts, gets a label."""
        ...


@dataclass(frozen=True)
class LabelRule:
    """One rule: what asks as the episode goes on, or that it is looked back at once it is over."""

    make: Callable[[LabellingConfig], AsksForLabels] | None = None
    """makes what asks; None: nothing asks meanwhile"""
    looks_back: bool = False
    """whether the last steps of an episode that failed are labelled afterwards"""


OWN = LabelRule()
BEFORE_FAILURE = LabelRule(looks_back=True)

LABELS: Registry[LabelRule] = Registry(
    "label rule",
    "sheath.labels",
    {
        "all": f"{__name__}.every_step:ALL",
        "own": f"{__name__}:OWN",
        "drawn": f"{__name__}.drawn_steps:DRAWN",
        "before-failure": f"{__name__}:BEFORE_FAILURE",
    },
    of=LabelRule,
)


def label_rules(names: str) -> list[LabelRule]:
    """Return the rules of these names, joined by `+`; raises UnknownNameError."""
    return [LABELS[name] for name in names.split(AND)]


def require_label_rules(names: str) -> None:
    """Raise ParameterError where one of the names is that of no rule; nothing is imported."""
    if not all(name in LABELS for name in names.split(AND)):
        raise ParameterError(
            f"labels is {names!r}; wanted {', '.join(LABELS)}, or several joined by {AND}"
        )
