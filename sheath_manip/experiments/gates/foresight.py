"""Alarms before failures: how many failures a gate foresees, how early, and at what price.

The score of a window is its lowest. An alarm before a failure must come within the window before
the failing step, at least one step ahead of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.experiments.gates.detection import Rate, alarms, rate_of


@dataclass(frozen=True, eq=False)
class Drive:
    """The scores of one episode of the policy alone."""

    scores: NDArray[np.float64]
    """(T,); in a failed episode the last step is the failing one"""
    failed: bool


@dataclass(frozen=True)
class Foresight:
    """What the alarms of one threshold are worth."""

    threshold: float
    foreseen: Rate
    """of the failures, with an alarm in the window before"""
    disturbed: Rate
    """of the failure-free windows, with an alarm in them"""
    lead_steps: float
    """median over the foreseen failures, from the first step of the unbroken run of alarms that
    the window's first alarm belongs to (it may begin before the window), to the failing step"""
    failed: Rate
    """of the failed episodes, those with an alarm anywhere before the failing step"""
    unfailed: Rate
    """of the other episodes, those with an alarm anywhere: with `failed` the four-way table"""


def foresight(drives: Sequence[Drive], threshold: float, window: int, spared: int) -> Foresight:
    """Count alarms; for `window` and `spared` see `before_failure` and `failure_free`."""
    failed = [drive for drive in drives if drive.failed]
    others = [drive for drive in drives if not drive.failed]
    leads = [lead_steps(drive.scores, threshold, window) for drive in failed]
    free = failure_free(drives, window, spared)
    return Foresight(
        threshold=threshold,
        foreseen=rate_of([lead is not None for lead in leads]),
        disturbed=rate_of(alarms(free, threshold)),
        lead_steps=_median([lead for lead in leads if lead is not None]),
        failed=rate_of([bool(alarms(d.scores[:-1], threshold).any()) for d in failed]),
        unfailed=rate_of([bool(alarms(d.scores, threshold).any()) for d in others]),
    )


def before_failure(drives: Sequence[Drive], window: int) -> NDArray[np.float64]:
    """(failures,) the lowest score in the `window` steps before each failing step."""
    return np.array(
        [
            _lowest(drive.scores[-1 - window : -1])
            for drive in drives
            if drive.failed and len(drive.scores) > 1
        ]
    )


def failure_free(drives: Sequence[Drive], window: int, spared: int) -> NDArray[np.float64]:
    """(windows,) the lowest score of each window of episodes without failure.

    Of a failed episode all but the last `spared` steps count as such. Windows follow each other;
    what is left over at the end is no window.
    """
    kept = [drive.scores[:-spared] if drive.failed else drive.scores for drive in drives]
    return np.concatenate([np.empty(0), *(window_scores(scores, window) for scores in kept)])


def window_scores(scores: NDArray, window: int) -> NDArray[np.float64]:
    """(T // window,) the lowest score of each."""
    count = len(scores) // window
    return np.array([_lowest(part) for part in np.split(scores[: count * window], max(count, 1))])[
        :count
    ]


def lead_steps(scores: NDArray, threshold: float, window: int) -> int | None:
    """Return how many steps ahead of the last one the alarm began.

    The answer is None without an alarm in the window.
    """
    alarmed = alarms(scores, threshold)
    last = len(scores) - 1
    begin = max(last - window, 0)
    within = np.flatnonzero(alarmed[begin:last])
    if not len(within):
        return None
    first = begin + int(within[0])
    while first > 0 and alarmed[first - 1]:
        first -= 1
    return last - first


def _lowest(scores: NDArray) -> float:
    return float(np.min(np.where(np.isnan(scores), -np.inf, scores), initial=np.inf))


def _median(values: Sequence[int]) -> float:
    return float(np.median(values)) if values else float("nan")
