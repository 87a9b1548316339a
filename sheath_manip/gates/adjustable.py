"""A support gate whose boundary a person moves while the robot runs."""

from dataclasses import dataclass, replace

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.support import SupportGate
from sheath_manip.protocols import Judge
from sheath_manip.types import GateDecision, Observation, Proposal


@dataclass(frozen=True, eq=False)
class Boundary:
    """What a support gate goes by, as one value: a step never sees half of a new one."""

    judge: Judge
    threshold: float
    lowest: float
    """the threshold that a person may set, at least"""
    highest: float
    """and at most"""
    minimum_hold_steps: int | None = None
    """for which the expert acts at least; None: as the gate was made"""

    def at(self, threshold: float) -> "Boundary":
        """Return this boundary with another threshold, clamped.

        Raises ParameterError where it is no number.
        """
        if not np.isfinite(threshold):
            raise ParameterError(f"threshold is {threshold}; wanted a finite score, like 0.0")
        return replace(self, threshold=min(max(threshold, self.lowest), self.highest))


class Dial:
    """Holds the boundary; set from any thread, read by the gate at each step."""

    def __init__(self, boundary: Boundary) -> None:
        self.boundary = boundary


class Adjustable:
    """Decides as a support gate at the boundary that the dial has in this step."""

    def __init__(self, gate: SupportGate, dial: Dial) -> None:
        self.gate = gate
        self.dial = dial

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode."""
        self.gate.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide as the gate does."""
        boundary = self.dial.boundary
        self.gate.judge, self.gate.threshold = boundary.judge, boundary.threshold
        if boundary.minimum_hold_steps is not None:
            self.gate.minimum_hold_steps = boundary.minimum_hold_steps
        return self.gate.decide(observation, proposal)


def around(judge: Judge, threshold: float, scores: np.ndarray) -> Boundary:
    """A boundary that may be moved over all `scores` (n,) of states, and to where each is outside.

    Without any it may be moved by as much as it is away from 0, at least 1.
    """
    return Boundary(judge, threshold, *span_of(threshold, scores))


def span_of(threshold: float, scores: np.ndarray) -> tuple[float, float]:
    """Return the lowest and the highest threshold that a person may look at, as `around` says."""
    known = np.asarray(scores, float)[np.isfinite(scores)]
    if not known.size:
        reach = max(1.0, abs(threshold))
        return threshold - reach, threshold + reach
    low, high = float(known.min()), float(known.max())
    reach = 0.05 * max(high - low, 1e-6)
    return min(low, threshold) - reach, max(high, threshold) + reach
