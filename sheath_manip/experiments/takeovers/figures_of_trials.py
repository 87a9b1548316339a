"""What a way of taking over came to, with intervals by scene: what failed, and what it asked."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from sheath_manip.burden import Burden, StepCounts
from sheath_manip.experiments.takeovers.trial import Trial, mean_share

RESAMPLES = 4000
TAIL = (2.5, 97.5)


@dataclass(frozen=True)
class Weighed:
    """A trial, and how many of the policy's episodes its scene stands for."""

    trial: Trial
    weight: float


@dataclass(frozen=True)
class TrueMix:
    """The same weighed by how often scenes of either kind come."""

    failed: float
    takeovers_an_episode: float
    share: float


@dataclass(frozen=True)
class Found:
    """What happened under one way, on the scenes in which the policies fail alone."""

    scenes: int
    failed: int
    stuck: int
    """of those that failed"""
    rate: float
    """of failed"""
    ci95: tuple[float, float]
    """bootstrap by scene, since several policies meet the same"""
    burden: Burden
    """of its labels each is a step that the expert drove"""
    expert_share: float
    """of the steps"""
    broken: int
    """failed of the scenes in which the policies succeed alone"""
    unbroken: int
    """the rest of these"""
    true_mix: TrueMix


def found(trials: Sequence[Weighed], control_rate_hz: float) -> Found:
    """Return what `trials` of one way say."""
    failing = [each.trial for each in trials if each.trial.failing]
    others = [each.trial for each in trials if not each.trial.failing]
    failed = np.array([trial.fails for trial in failing], float)
    broken = sum(trial.fails for trial in others)
    weights = np.array([each.weight for each in trials])
    counts = np.array([len(each.trial.turns) for each in trials])
    steps, driven = (
        np.array([getattr(each.trial, name) for each in trials])
        for name in ("steps", "expert_steps")
    )
    fails = np.array([each.trial.fails for each in trials])
    return Found(
        scenes=len(failing),
        failed=int(failed.sum()),
        stuck=sum(trial.stuck for trial in failing),
        rate=float(failed.mean()) if failing else float("nan"),
        ci95=interval([trial.seed for trial in failing], failed),
        burden=burden_of(failing, control_rate_hz),
        expert_share=mean_share(failing),
        broken=broken,
        unbroken=len(others) - broken,
        true_mix=TrueMix(
            failed=float(np.average(fails, weights=weights)),
            takeovers_an_episode=float(np.average(counts, weights=weights)),
            share=float((weights * driven).sum() / (weights * steps).sum()),
        ),
    )


def burden_of(trials: Sequence[Trial], control_rate_hz: float) -> Burden:
    """Return what `trials` asked of the expert."""
    driving_steps = sum(trial.expert_steps for trial in trials)
    steps = sum(trial.steps for trial in trials)
    turns_s = [count / control_rate_hz for trial in trials for _, count in trial.turns]
    counts = StepCounts(
        episodes=len(trials),
        steps=steps,
        driving_steps=driving_steps,
        active_s=steps / control_rate_hz,
        driving_s=driving_steps / control_rate_hz,
        takeovers=len(turns_s),
        labels=driving_steps,
    )
    return Burden.of(counts, turns_s)


def difference(
    seeds: Sequence[int], ours: NDArray[np.float64], theirs: NDArray[np.float64]
) -> tuple[float, float]:
    """Return the interval of by how much more of the same (n,) scenes fail under theirs."""
    return interval(seeds, np.asarray(theirs, float) - np.asarray(ours, float))


def interval(seeds: Sequence[int], values: NDArray[np.float64]) -> tuple[float, float]:
    """Return the bootstrap's 95 % interval of the mean of (n,) values; scenes are drawn whole.

    (NaN, NaN) where there is none.
    """
    if not len(values):
        return float("nan"), float("nan")
    _, groups = np.unique(np.asarray(seeds), return_inverse=True)
    sums = np.bincount(groups, weights=values)
    sizes = np.bincount(groups)
    drawn = _resamples(len(sums))
    low, high = np.percentile((drawn @ sums) / (drawn @ sizes), TAIL)
    return float(low), float(high)


@lru_cache(maxsize=16)
def _resamples(count: int) -> NDArray[np.int64]:
    """(RESAMPLES, count) how often each is drawn; the same at every call."""
    return np.random.default_rng(0).multinomial(count, np.full(count, 1 / count), RESAMPLES)
