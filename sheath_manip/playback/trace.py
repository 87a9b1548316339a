"""The steps of one episode by column: what plots, timelines and trails are drawn from."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sheath_manip.metrics import runs_of
from sheath_manip.types import ACTORS, REASONS, Actor, Episode, EpisodeInfo, Reason, ScenePose, Step
from sheath_manip.types.columns import intervened

POLICY = ACTORS.index(Actor.POLICY)
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
    actor: NDArray[np.uint8]
    """(n,) who acted: place in ACTORS"""
    intervention: NDArray[np.bool_]
    """(n,) somebody else than the policy acted, though there was one"""
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
        if stop >= len(self):
            return self
        return Trace(*(getattr(self, name)[:stop] for name in Trace.__dataclass_fields__))

    @cached_property
    def turns(self) -> list[tuple[int, int]]:
        """Every intervention as (first step, first step after it)."""
        return runs_of(self.intervention)

    @cached_property
    def by_policy(self) -> NDArray[np.bool_]:
        """(n,) whether the policy acted."""
        return self.actor == POLICY

    def who_and_why(self, step: int) -> tuple[Actor, Reason]:
        """Return who acted in a step, and for which reason."""
        return ACTORS[self.actor[step]], REASONS[self.reason[step]]


class GrowingTrace:
    """A trace that one thread appends to while others look at what is there already."""

    def __init__(self, info: EpisodeInfo) -> None:
        self._info = info
        self._length = 0
        room = FIRST_CAPACITY
        self._columns = Trace(
            time_s=np.zeros(room),
            score=np.zeros(room),
            threshold=np.zeros(room),
            actor=np.zeros(room, np.uint8),
            intervention=np.zeros(room, bool),
            query=np.zeros(room, bool),
            limited=np.zeros(room, bool),
            reason=np.zeros(room, np.uint8),
            tool_m=np.zeros((room, 3)),
        )

    def append(self, step: Step, pose: ScenePose | None = None) -> None:
        """Add one step, and where it is known how the scene stood after it."""
        at, decision = self._length, step.decision
        if at == len(self._columns):
            self._columns = _doubled(self._columns)
        columns = self._columns
        columns.time_s[at] = step.observation.time_s
        columns.score[at], columns.threshold[at] = decision.score, decision.threshold
        columns.actor[at] = ACTORS.index(decision.actor)
        columns.intervention[at] = intervened(step, bool(self._info.checkpoint))
        columns.query[at] = step.label is not None
        columns.limited[at] = bool(step.limited)
        columns.reason[at] = REASONS.index(decision.reason)
        columns.tool_m[at] = NOWHERE if pose is None or pose.tool_m is None else pose.tool_m
        # Last, so that a reader meanwhile sees only what is complete.
        self._length += 1

    def so_far(self) -> Trace:
        """Return what has been appended; it does not change any more."""
        return self._columns.until(self._length)


def trace_of(episode: Episode) -> Trace:
    """Return a recorded episode by column, without the way of its tool."""
    trace = GrowingTrace(episode.info)
    for step in episode.steps:
        trace.append(step)
    return trace.so_far()


def _doubled(columns: Trace) -> Trace:
    """A copy with room for as many again: readers of the old one are not disturbed."""
    arrays = (getattr(columns, name) for name in Trace.__dataclass_fields__)
    return Trace(*(np.concatenate([array, np.zeros_like(array)]) for array in arrays))
