"""Notices that nothing goes on: to be stuck is to fail, though each state be familiar.

A signal looks at single states, and a robot that stands still in a familiar one raises no alarm;
neither does one that goes to and fro, or in a circle. What is watched here is how far the newest
half of a while leads away from all states of its older half, in units of the features' spread,
against the least that the expert itself got on in as long a while.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.protocols import Arrays, Gate
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason

SHARE = 0.5
"""of the least that the expert got on, below which nothing goes on"""


@dataclass(frozen=True, eq=False)
class Progress:
    """How little the expert gets on within a while."""

    steps: int
    """of the while"""
    spread: NDArray[np.float64]
    """(f,) from the lowest to the highest of each feature, over all of the expert's states"""
    least: float
    """how far the expert got in its stillest while; 0, which nothing is below, where no episode was
    as long"""

    @classmethod
    def of(cls, episodes: Sequence[NDArray], steps: int) -> Self:
        """Measure (n_k, f) features of the expert's episodes, in whiles of so many steps."""
        together = np.concatenate(episodes).astype(np.float64)
        spread = np.ptp(together, axis=0)
        spread = np.where(spread > 0, spread, np.inf)
        lately, got_on = While(steps, spread), []
        for episode in episodes:
            lately.forget()
            got_on += [lately.add(features) for features in episode]
        least = min(got_on, default=np.inf)
        return cls(steps, spread, least if np.isfinite(least) else 0.0)

    def is_stuck(self, got_on: float) -> bool:
        """Tell whether nothing goes on where a robot `got_on` so far in a whole while."""
        return got_on < SHARE * self.least

    def arrays(self) -> Arrays:
        """Return what was learned."""
        return {
            "steps": np.array(self.steps),
            "spread": np.where(np.isfinite(self.spread), self.spread, 0.0),
            "least_got_on": np.array(self.least),
        }

    @classmethod
    def load(cls, arrays: Arrays) -> Self:
        """Return what `arrays` gave; raises ParameterError for anything else."""
        spread = numbers(arrays, "spread", None).astype(np.float64)
        return cls(
            int(numbers(arrays, "steps")),
            np.where(spread > 0, spread, np.inf),
            float(numbers(arrays, "least_got_on")),
        )


class While:
    """The last steps of an episode, and how far they have led.

    For each state of the newest half the nearest one of the older half is looked for. Of these
    distances, Euclidean in units of the spread, the largest is how far the robot got on: one that
    comes back to where it was has not got on.
    """

    def __init__(self, steps: int, spread: NDArray) -> None:
        """Store how many steps a while has, at least 2, and (f,) the units of the features."""
        self.steps = steps
        self.spread = spread
        self._newest = steps // 2
        self.forget()

    def forget(self) -> None:
        """Begin an episode."""
        self._rows = np.zeros((self.steps, len(self.spread)), np.float32)
        """states in a ring"""
        self._apart = np.zeros((2 * self.steps, 2 * self.steps), np.float32)
        """squared distances of each state to those before it; the ring is there twice each way, so
        that what follows each other lies side by side"""
        self._seen = 0

    def add(self, features: NDArray) -> float:
        """Take (f,) the features of a step; how far the robot got on, inf before a while is over.

        Without features nothing is known: inf.
        """
        row = (features / self.spread).astype(np.float32)
        place = self._seen % self.steps
        self._rows[place] = row
        self._seen += 1
        differences = self._rows - row
        squared = np.einsum("ij,ij->i", differences, differences)
        again = place + self.steps
        self._apart[place] = self._apart[again] = np.concatenate([squared, squared])
        if self._seen < self.steps or not row.size:
            return np.inf
        # The newest half, and before it the older one.
        begins = again + 1 - self._newest
        apart = self._apart[begins : again + 1, place + 1 : begins]
        return float(np.sqrt(apart.min(axis=1).max()))


class ProgressGate:
    """Another gate, which hands over to the expert as well where nothing goes on."""

    def __init__(self, gate: Gate, progress: Progress) -> None:
        """Store who else judges, and what counts as getting on."""
        self.gate = gate
        self.progress = progress
        self._lately = While(progress.steps, progress.spread)

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode."""
        self.gate.reset(rng)
        self._lately.forget()

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does, and for the expert where the policy has got nowhere."""
        decision = self.gate.decide(observation, proposal)
        got_on = self._lately.add(observation.features)
        if decision.actor is not Actor.POLICY or not self.progress.is_stuck(got_on):
            return decision
        return replace(decision, actor=Actor.EXPERT, query=True, reason=Reason.STUCK)
