"""Areas under learning curves: how good a method was over all its rounds, training runs paired."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from sheath_manip.learning.results import RoundResult
from sheath_manip.metrics import EpisodeRecord, bounded_interval, mean_interval

COMPARED_TO = "dagger"


def areas(results: Mapping[str, Sequence[RoundResult]], metric: str) -> dict[str, dict[str, Any]]:
    """Return, by method, what its rounds from 1 on amount to, executed and of the policy alone.

    Each has the mean over training runs of the run's mean of `metric` over its rounds (of a round's
    episodes, their mean), and `minus_dagger`, the mean of what a run has more than DAgger's of the
    same seed: same demonstrations, same scenes. Intervals are 95 %, the bootstrap's of a mean and
    Student's of a difference; runs count as independent.
    """
    by_run = {
        (method, what): _by_run(rounds, what, metric)
        for method, rounds in results.items()
        for what in ("executed", "policy")
    }
    return {
        method: {
            what: {
                **_mean(by_run[method, what], bounded_interval),
                "minus_dagger": _mean(
                    _difference(by_run[method, what], by_run.get((COMPARED_TO, what), {})),
                    mean_interval,
                ),
            }
            for what in ("executed", "policy")
        }
        for method in results
    }


def _by_run(results: Sequence[RoundResult], what: str, metric: str) -> dict[int, float]:
    """By seed, the mean over rounds 1 and up; runs without such rounds are left out."""
    rounds: dict[int, list[float]] = {}
    for result in results:
        records: Sequence[EpisodeRecord] = getattr(result, what)
        values = [record.metrics[metric] for record in records if metric in record.metrics]
        if result.round > 0 and values:
            rounds.setdefault(result.run_seed, []).append(float(np.mean(values)))
    return {seed: float(np.mean(means)) for seed, means in rounds.items()}


def _difference(ours: Mapping[int, float], others: Mapping[int, float]) -> dict[int, float]:
    return {seed: value - others[seed] for seed, value in ours.items() if seed in others}


def _mean(
    by_run: Mapping[int, float], interval: Callable[[np.ndarray], tuple[float, float]]
) -> dict[str, Any]:
    if not by_run:
        return {"runs": 0, "mean": math.nan, "ci95": (math.nan, math.nan)}
    values = np.array(list(by_run.values()))
    return {
        "runs": len(values),
        "mean": float(values.mean()),
        "ci95": interval(values),
    }
