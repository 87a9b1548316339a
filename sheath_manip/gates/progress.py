"""Notices that nothing goes on: to be stuck is to fail, though each state be familiar.

A signal looks at single states, and a robot that stands still in a familiar one raises no alarm.
What is watched here is how far the features move within a while, in units of their spread, against
the stillest while in which the expert itself got on.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.protocols import Arrays, Gate
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason

SHARE = 0.5
"""of the expert's own least motion, below which nothing goes on"""


@dataclass(frozen=True, eq=False)
class Progress:
    """How little the expert moves within a while."""

    steps: int
    """of the while"""
    spread: NDArray[np.float64]
    """(f,) from the lowest to the highest of each feature, over all of the expert's states"""
    least: float
    """motion of the expert in its stillest while; 0, which nothing is below, where no episode was
    as long"""

    @classmethod
    def of(cls, episodes: Sequence[NDArray], steps: int) -> Self:
        """Measure (n_k, f) features of the expert's episodes, in whiles of so many steps."""
        together = np.concatenate(episodes).astype(np.float64)
        spread = np.ptp(together, axis=0)
        found = cls(steps, np.where(spread > 0, spread, np.inf), 0.0)
        whiles = [
            found.motion(episode[first : first + steps])
            for episode in episodes
            for first in range(len(episode) - steps + 1)
        ]
        return replace(found, least=min(whiles, default=0.0))

    def motion(self, features: NDArray) -> float:
        """Return how far the feature that moves most does, within (n, f) `features` of a while."""
        moved = np.ptp(np.asarray(features, np.float64), axis=0) / self.spread
        return float(moved.max()) if moved.size else 0.0

    def is_stuck(self, features: NDArray) -> bool:
        """Tell whether nothing goes on in (n, f) `features` of a whole while."""
        return self.motion(features) < SHARE * self.least

    def arrays(self) -> Arrays:
        """Return what was learned."""
        return {
            "steps": np.array(self.steps),
            "spread": np.where(np.isfinite(self.spread), self.spread, 0.0),
            "least": np.array(self.least),
        }

    @classmethod
    def load(cls, arrays: Arrays) -> Self:
        """Return what `arrays` gave; raises ParameterError for anything else."""
        spread = numbers(arrays, "spread", None).astype(np.float64)
        return cls(
            int(numbers(arrays, "steps")),
            np.where(spread > 0, spread, np.inf),
            float(numbers(arrays, "least")),
        )


class ProgressGate:
    """Another gate, which hands over to the expert as well where nothing goes on."""

    def __init__(self, gate: Gate, progress: Progress) -> None:
        """Store who else judges, and what counts as getting on."""
        self.gate = gate
        self.progress = progress
        self._lately: deque[NDArray] = deque(maxlen=progress.steps)

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode."""
        self.gate.reset(rng)
        self._lately.clear()

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does, and for the expert where the policy has got nowhere."""
        decision = self.gate.decide(observation, proposal)
        self._lately.append(observation.features)
        if decision.actor is not Actor.POLICY or len(self._lately) < self.progress.steps:
            return decision
        if not self.progress.is_stuck(np.stack(self._lately)):
            return decision
        return replace(decision, actor=Actor.EXPERT, query=True, reason=Reason.STUCK)
