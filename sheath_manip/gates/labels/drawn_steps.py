"""A share of the policy's steps is labelled, drawn: few labels that speak for all states visited.

Of equally few, labels drawn at random taught more than those of the states with the lowest scores,
most of which came from one stuck episode.
"""

import numpy as np

from sheath_manip.gates.labels import LabelRule
from sheath_manip.types import GateDecision, Observation


class DrawnSteps:
    """Asks with a probability, drawn anew at each step."""

    def __init__(self, share: float) -> None:
        """Store the share of the steps, 0 .. 1."""
        self.share = share
        self._rng = np.random.default_rng(0)

    def reset(self, rng: np.random.Generator) -> None:
        """Draw from `rng` from now on."""
        self._rng = rng

    def asks(self, observation: Observation, decision: GateDecision) -> bool:  # noqa: ARG002
        """Return what is drawn."""
        return bool(self._rng.random() < self.share)


DRAWN = LabelRule(lambda config: DrawnSteps(config.drawn_share))
