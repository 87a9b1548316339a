"""What an episode amounts to, and what a set of them says: rates and means with intervals."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from sheath_manip.types import Episode, Outcome

CONFIDENCE = 0.95
RESAMPLES = 4000
"""of the bootstrap: the ends of its intervals are repeatable, and right to a few per cent"""
ENDED: Mapping[Outcome, str] = {
    Outcome.SUCCESS: "succeeded",
    Outcome.FAILURE: "failed",
    Outcome.TIME_LIMIT: "stuck",
    Outcome.ERROR: "cut short",
}
"""the word that every table and page has for episodes of an outcome: each is counted apart, since
what did not fail may be stuck, the time limit having come first"""
RATES: Mapping[Outcome, str] = {
    Outcome.SUCCESS: "success_rate",
    Outcome.FAILURE: "failure_rate",
    Outcome.TIME_LIMIT: "stuck_rate",
}
"""the entry of `Figures` for each"""


@dataclass(frozen=True)
class EpisodeRecord:
    """The figures of one episode, without its images."""

    seed: int
    outcome: Outcome
    metrics: Mapping[str, float]
    steps: int
    expert_steps: int
    """steps driven in the policy's place: by the expert, an operator or a fallback controller"""
    queries: int
    """steps with a label, whether the expert acted or was only asked"""
    switches: int
    """changes of who acts"""
    interventions: int
    """runs of steps in which somebody else than the policy acts, in an episode that has one"""
    hold_steps: int = 0
    """steps in which nobody drove and the robot was held"""
    limited_steps: int = 0
    """steps whose command a command filter changed"""
    control_rate_hz: float = float("nan")
    """NaN in results of before it was kept"""
    turns: tuple[int, ...] = ()
    """steps that somebody drove in each of the interventions; none in results of before they were
    kept"""


@dataclass(frozen=True)
class Figures:
    """What a set of episodes says. Intervals are 95 %; episodes count as independent."""

    episodes: int
    failure_rate: float
    success_rate: float
    stuck_rate: float
    """share in which the time limit came before success and failure"""
    metric: Mapping[str, float]
    """means"""
    ci95: Mapping[str, tuple[float, float]]
    """of the three rates (Wilson) and of each metric (bootstrap)"""


def record_of(episode: Episode) -> EpisodeRecord:
    """Return the figures of one episode."""
    columns = episode.columns
    turns = runs_of(columns.intervention)
    driven = columns.in_place_of_policy
    return EpisodeRecord(
        seed=episode.info.seed,
        outcome=episode.outcome,
        metrics=dict(episode.metrics),
        steps=len(episode),
        expert_steps=int(columns.in_place_of_policy.sum()),
        queries=int(columns.has_label.sum()),
        hold_steps=int(columns.held.sum()),
        switches=int(np.count_nonzero(np.diff(columns.by_policy.astype(int)))),
        interventions=len(turns),
        limited_steps=int(columns.limited.sum()),
        control_rate_hz=episode.info.control_rate_hz,
        turns=tuple(int(driven[start:stop].sum()) for start, stop in turns),
    )


def runs_of(mask: np.ndarray) -> list[tuple[int, int]]:
    """Return each run of true values in (n,) `mask` as (first, first after it).

    Of `Columns.intervention` these are the interventions.
    """
    edges = np.flatnonzero(np.diff(mask.astype(np.int8), prepend=0, append=0))
    return [(int(start), int(stop)) for start, stop in edges.reshape(-1, 2)]


def figures_of(records: Sequence[EpisodeRecord]) -> Figures:
    """Rates and means of `records`; all NaN where there are none."""
    count = len(records)
    ended = Counter(record.outcome for record in records)
    names = sorted({name for record in records for name in record.metrics})
    values = {name: np.array([record.metrics[name] for record in records]) for name in names}
    return Figures(
        episodes=count,
        **{rate: ended[each] / count if count else float("nan") for each, rate in RATES.items()},
        metric={name: float(column.mean()) for name, column in values.items()},
        ci95={
            **{rate: rate_interval(ended[each], count) for each, rate in RATES.items()},
            **{name: bounded_interval(column) for name, column in values.items()},
        },
    )


def endings(figures: Mapping[str, Any]) -> dict[str, tuple[float | None, Sequence[float]]]:
    """Return rate and 95 % interval by word, of `Figures` as plain values, such as a summary's.

    Where an older summary does not say how many were stuck, they are the rest. None: no episode.
    """
    found = {ENDED[each]: (figures.get(r), figures["ci95"].get(r)) for each, r in RATES.items()}
    stuck = ENDED[Outcome.TIME_LIMIT]
    if "stuck_rate" not in figures and figures["success_rate"] is not None:
        count = figures["episodes"]
        rest = max(0, round(count * (1 - figures["success_rate"] - figures["failure_rate"])))
        found[stuck] = rest / count, rate_interval(rest, count)
    return found


def endings_line(outcomes: Iterable[Outcome]) -> str:
    """Return how many episodes ended in which way: `3 succeeded, 1 failed, 0 stuck`."""
    counts = Counter(outcomes)
    return ", ".join(
        f"{counts[each]} {word}"
        for each, word in ENDED.items()
        if each is not Outcome.ERROR or counts[each]
    )


def expert_share(records: Sequence[EpisodeRecord]) -> float:
    """Share of all steps in which the expert acted."""
    return _share_of_steps(records, sum(record.expert_steps for record in records))


def expert_share_interval(records: Sequence[EpisodeRecord]) -> tuple[float, float]:
    """Return the 95 % interval of `expert_share`, whose episodes count as independent."""
    steps = np.array([record.steps for record in records if record.steps], float)
    if not len(steps):
        return 0.0, 1.0
    acted = np.array([record.expert_steps for record in records if record.steps], float)
    return bounded_interval(acted / steps, steps)


def limited_share(records: Sequence[EpisodeRecord]) -> float:
    """Share of all steps in which a command filter changed the command."""
    return _share_of_steps(records, sum(record.limited_steps for record in records))


def _share_of_steps(records: Sequence[EpisodeRecord], counted: int) -> float:
    steps = sum(record.steps for record in records)
    return counted / steps if steps else float("nan")


def rate_interval(hits: int, count: int) -> tuple[float, float]:
    """Wilson's 95 % interval of a rate; (0, 1) where nothing was counted."""
    if count == 0:
        return 0.0, 1.0
    # Only now: it takes half a second, and who counts episodes wants no interval.
    from scipy import stats

    interval = stats.binomtest(hits, count).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)


def bounded_interval(values: np.ndarray, weights: np.ndarray | None = None) -> tuple[float, float]:
    """Return the bootstrap's 95 % interval of the mean of (n,) values, as of a metric with bounds.

    The percentiles of the means of resamples never leave the range of the values, hence never what
    is possible. Of fewer than about ten values they are too close together, as nothing is known of
    what was not seen. With (n,) positive `weights` the mean is weighted, as a share of all steps is
    the mean of the episodes' shares by their steps.
    """
    if weights is None:
        means = _resamples(len(values)) @ values
    else:
        drawn = _resamples(len(values)) * weights
        means = drawn @ values / drawn.sum(1)
    tail = 50.0 * (1.0 - CONFIDENCE)
    low, high = np.percentile(means, (tail, 100.0 - tail))
    # Rounding in the sums must not lead out of the range either.
    low, high = np.clip((low, high), values.min(), values.max())
    return float(low), float(high)


@lru_cache(maxsize=64)
def _resamples(count: int) -> np.ndarray:
    """(RESAMPLES, count) the share of each value in each resample; the same at every call."""
    weights = np.full(count, 1.0 / count)
    return np.random.default_rng(0).multinomial(count, weights, RESAMPLES) / count


def mean_interval(values: np.ndarray) -> tuple[float, float]:
    """Return Student's 95 % interval of the mean of (n,) values; the mean itself where n < 2.

    For what has no bounds to leave, as differences of paired runs.
    """
    mean = float(np.mean(values))
    spread = float(np.std(values, ddof=1)) if len(values) > 1 else 0.0
    if spread == 0.0:
        return mean, mean
    from scipy import stats

    half = float(stats.t.ppf(0.5 + CONFIDENCE / 2, len(values) - 1)) * spread / len(values) ** 0.5
    return mean - half, mean + half
