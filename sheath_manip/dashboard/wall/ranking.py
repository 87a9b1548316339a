"""The moments of an episode as the wall ranks them, worst first."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.moments import EpisodeMoments
from sheath_manip.dataset.reader import EpisodeSummary
from sheath_manip.types import Actor, Outcome, Reason


class Kind(StrEnum):
    """What a moment is, from bad to harmless: the order of the wall."""

    FAILURE = "failure"
    """the end of an episode that failed"""
    STUCK = "stuck"
    """the end of one that the time limit ended"""
    CUT_SHORT = "cut short"
    """the end of one in which something broke down"""
    IN_VAIN = "takeover in vain"
    """the last takeover of an episode that failed or was stuck all the same"""
    TAKEOVER = "takeover"
    """any other"""
    NEAR_MISS = "near miss"
    """the policy acted, with a score near its threshold or below it"""
    MARK = "mark"
    """what a person said afterwards"""


KINDS = tuple(Kind)
_ENDS = {
    Outcome.FAILURE: Kind.FAILURE,
    Outcome.TIME_LIMIT: Kind.STUCK,
    Outcome.ERROR: Kind.CUT_SHORT,
}


@dataclass(frozen=True)
class Moment:
    """One moment of an episode."""

    place: int
    """of the episode, in the catalog"""
    step: int
    kind: Kind
    margin: float = math.nan
    """see `dataset.moments`; NaN where there is none"""
    reason: Reason | None = None
    actor: Actor | None = None
    text: str = ""
    """what a person said"""

    @property
    def rank(self) -> tuple[int, float, int, int]:
        """What moments are sorted by: kind, then the lowest margin, then where it is.

        What has no margin comes after what has one.
        """
        margin = math.inf if math.isnan(self.margin) else self.margin
        return KINDS.index(self.kind), margin, self.place, self.step


def moments_of(
    place: int, summary: EpisodeSummary, marks: Marks, found: EpisodeMoments
) -> Iterator[Moment]:
    """Yield the moments of the episode at `place`, in no order.

    Args:
        place: in the catalog.
        summary: the episode at a glance, marks included.
        marks: a person's.
        found: what its steps tell of.
    """
    last = summary.length - 1
    end = _ENDS.get(summary.outcome)
    in_vain = end in (Kind.FAILURE, Kind.STUCK)
    if end is not None:
        yield Moment(place, last, end)
    for number, each in enumerate(found.takeovers, 1):
        is_last = number == len(found.takeovers)
        kind = Kind.IN_VAIN if in_vain and is_last else Kind.TAKEOVER
        yield Moment(place, each.start, kind, each.margin, each.reason, each.actor)
    for near in found.near_misses:
        yield Moment(place, near.step, Kind.NEAR_MISS, near.margin, None, Actor.POLICY)
    for note in marks.notes:
        # A note may be of a step that is not there.
        yield Moment(place, min(note.step, last), Kind.MARK, text=note.text)
    for start, stop in marks.bad:
        text = f"not learned from: steps {start + 1} .. {stop}"
        yield Moment(place, min(start, last), Kind.MARK, text=text)
    if marks.outcome is not None:
        yield Moment(place, last, Kind.MARK, text=f"outcome marked: {marks.outcome.value}")
