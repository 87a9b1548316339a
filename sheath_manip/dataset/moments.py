"""What happened in an episode that a person may want to see: takeovers, and near misses.

How near the threshold a score came is told as a margin: their difference, in units of what it
usually is in the same episode (the median of its size). So a margin of 0 lies on the threshold, 1
is as usual, and gates of different scores can be held against each other.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.header import Header
from sheath_manip.metrics import runs_of
from sheath_manip.types import Actor, Reason

COLUMNS = ("actor", "reason", "intervention", "score", "threshold")
"""the arrays that moments are found in"""
NEAR = 0.1
"""the margin below which a score is near its threshold"""
MOST_NEAR_MISSES = 3
"""of an episode, the nearest: a score that hovers at its threshold says the same thing each time"""
_UNBOUNDED = 1e30
"""Thresholds that reject everything are larger, and no score is near them."""
_ACTORS = {str(actor): actor for actor in Actor}
_REASONS = {str(reason): reason for reason in Reason}


class Takeover(NamedTuple):
    """An intervention: a run of steps in which somebody else than the policy acts.

    A tuple, since a wall reads hundreds of thousands of them, and a frozen dataclass takes thrice
    the time to be made.
    """

    start: int
    stop: int
    """the first step after it"""
    reason: Reason
    """of its first step"""
    actor: Actor
    """who drove most of it; `HOLD` where nobody drove"""
    margin: float
    """the lowest in it; NaN where there is no score"""


class NearMiss(NamedTuple):
    """A step in which the policy acted with a score that was near its threshold."""

    step: int
    margin: float


@dataclass(frozen=True)
class EpisodeMoments:
    """The moments of an episode that its steps tell of, in order of time."""

    takeovers: tuple[Takeover, ...] = ()
    near_misses: tuple[NearMiss, ...] = ()

    @classmethod
    def of(cls, header: Header, arrays: Mapping[str, NDArray]) -> "EpisodeMoments":
        """Return those of an episode, of whose arrays only `COLUMNS` are looked at."""
        margins = margins_of(arrays["score"], arrays["threshold"])
        taken = arrays["intervention"]
        codes = [code for code, actor in enumerate(header.actors) if actor is Actor.POLICY]
        near = (margins < NEAR) & np.isin(arrays["actor"], codes)
        return cls(
            tuple(_takeover(header, arrays, margins, *run) for run in runs_of(taken)),
            _near_misses(margins, near, taken),
        )


def margins_of(score: NDArray[np.float64], threshold: NDArray[np.float64]) -> NDArray[np.float64]:
    """(T,) how far above the threshold each score is; NaN where either is missing or unbounded."""
    with np.errstate(invalid="ignore", over="ignore"):
        above = score - threshold
    above = np.where(np.abs(above) < _UNBOUNDED, above, np.nan)
    sizes = np.abs(above[np.isfinite(above)])
    usual = float(np.median(sizes)) if sizes.size else 0.0
    return above / usual if usual > 0 else np.full(len(above), np.nan)


def moments_to_json(moments: EpisodeMoments) -> list[Any]:
    """Return the moments as strict JSON; `moments_from_json` is the inverse."""
    return [
        [
            [each.start, each.stop, str(each.reason), str(each.actor), _number(each.margin)]
            for each in moments.takeovers
        ],
        [[each.step, each.margin] for each in moments.near_misses],
    ]


def moments_from_json(told: Any) -> EpisodeMoments:
    """Return the moments; raises whatever Python does for what is none."""
    takeovers, near_misses = told
    return EpisodeMoments(
        tuple(
            Takeover(
                int(start),
                int(stop),
                _REASONS[reason],
                _ACTORS[actor],
                math.nan if margin is None else float(margin),
            )
            for start, stop, reason, actor, margin in takeovers
        ),
        tuple(NearMiss(int(step), float(margin)) for step, margin in near_misses),
    )


def _takeover(
    header: Header, arrays: Mapping[str, NDArray], margins: NDArray, start: int, stop: int
) -> Takeover:
    driven = [header.actors[code] for code in arrays["actor"][start:stop].tolist()]
    acting = [actor for actor in driven if actor is not Actor.HOLD] or driven
    known = margins[start:stop][np.isfinite(margins[start:stop])]
    return Takeover(
        start,
        stop,
        header.reasons[int(arrays["reason"][start])],
        max(dict.fromkeys(acting), key=acting.count),
        round(float(known.min()), 4) if known.size else math.nan,
    )


def _near_misses(
    margins: NDArray, near: NDArray[np.bool_], taken: NDArray[np.bool_]
) -> tuple[NearMiss, ...]:
    found = []
    for start, stop in runs_of(near):
        # The way into a takeover, or out of one, is told of by that.
        if not (taken[max(start - 1, 0)] or taken[min(stop, len(taken) - 1)]):
            step = start + int(margins[start:stop].argmin())
            found.append(NearMiss(step, round(float(margins[step]), 4)))
    nearest = sorted(found, key=lambda each: each.margin)[:MOST_NEAR_MISSES]
    return tuple(sorted(nearest, key=lambda each: each.step))


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
