"""The steps of one episode by column: what plots, timelines and trails are drawn from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import Actor, Reason, ScenePose, Step

REASONS = tuple(Reason)
FIRST_CAPACITY = 512
NOWHERE = np.full(3, np.nan)


@dataclass(frozen=True, eq=False)
class Trace:
    """n steps; the arrays must not be written to."""

    time_s: NDArray[np.float64]
    """(n,) before the action"""
    score: NDArray[np.float64]
    """(n,) NaN where the gate has none"""
    threshold: NDArray[np.float64]
    """(n,) NaN where the gate has none"""
    by_expert: NDArray[np.bool_]
    """(n,) who acted"""
    intervention: NDArray[np.bool_]
    """(n,) the expert acted while there was a policy that might have"""
    query: NDArray[np.bool_]
    """(n,) whether there is a label"""
    limited: NDArray[np.bool_]
    """(n,) whether a command filter changed the command"""
    reason: NDArray[np.uint8]
    """(n,) place in REASONS"""
    tool_m: NDArray[np.float64]
    """(n, 3) after the action, NaN where the task has no tool"""

    def __len__(self) -> int:
        return len(self.time_s)

    def until(self, stop: int) -> "Trace":
        """The first `stop` steps."""
        return Trace(*(getattr(self, name)[:stop] for name in Trace.__dataclass_fields__))

    @property
    def turns(self) -> list[tuple[int, int]]:
        """Every intervention as (first step, first step after it)."""
        edges = np.flatnonzero(np.diff(self.intervention.astype(np.int8), prepend=0, append=0))
        return [(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


class GrowingTrace:
    """A trace that one thread appends to while others look at what is there already."""

    def __init__(self) -> None:
        self._length = 0
        room = FIRST_CAPACITY
        self._columns = Trace(
            time_s=np.zeros(room),
            score=np.zeros(room),
            threshold=np.zeros(room),
            by_expert=np.zeros(room, bool),
            intervention=np.zeros(room, bool),
            query=np.zeros(room, bool),
            limited=np.zeros(room, bool),
            reason=np.zeros(room, np.uint8),
            tool_m=np.zeros((room, 3)),
        )

    def append(self, step: Step, pose: ScenePose) -> None:
        """Add one step and how the scene stood after it."""
        at, decision = self._length, step.decision
        if at == len(self._columns):
            self._columns = _doubled(self._columns)
        columns = self._columns
        by_expert = decision.actor is Actor.EXPERT
        # An invalid proposal is stored as none at all, though a policy made it.
        has_policy = step.proposed is not None or decision.reason is Reason.INVALID_PROPOSAL
        columns.time_s[at] = step.observation.time_s
        columns.score[at], columns.threshold[at] = decision.score, decision.threshold
        columns.by_expert[at] = by_expert
        columns.intervention[at] = by_expert and has_policy
        columns.query[at] = step.label is not None
        columns.limited[at] = bool(step.limited)
        columns.reason[at] = REASONS.index(decision.reason)
        columns.tool_m[at] = NOWHERE if pose.tool_m is None else pose.tool_m
        # Last, so that whoever looks meanwhile sees only what is complete.
        self._length += 1

    def so_far(self) -> Trace:
        """What has been appended; it does not change any more."""
        return self._columns.until(self._length)


def _doubled(columns: Trace) -> Trace:
    """A copy with room for as many again: readers of the old one are not disturbed."""
    arrays = (getattr(columns, name) for name in Trace.__dataclass_fields__)
    return Trace(*(np.concatenate([array, np.zeros_like(array)]) for array in arrays))
