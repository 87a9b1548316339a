"""Every state is labelled, the policy's as well: DAgger's rule, and the paper's."""

import numpy as np

from sheath_manip.gates.labels import LabelRule
from sheath_manip.types import GateDecision, Observation


class EveryStep:
    """Asks at every step."""

    def reset(self, rng: np.random.Generator) -> None:
        """Do nothing: there is nothing to forget."""

    def asks(self, observation: Observation, decision: GateDecision) -> bool:  # noqa: ARG002
        """Return True: every step is asked about."""
        return True


ALL = LabelRule(lambda _: EveryStep())
