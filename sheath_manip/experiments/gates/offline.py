"""What a gate's scores say about recorded states: the expert's, displaced ones, the policy's."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sheath_manip.experiments.gates.detection import Rate, alarms, auroc, detected, rate_of
from sheath_manip.experiments.gates.displaced import displaced_states
from sheath_manip.experiments.gates.foresight import (
    Drive,
    Foresight,
    before_failure,
    failure_free,
    foresight,
    window_scores,
)
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.experiments.gates.visited import Visit, visits
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.policies.looking import look
from sheath_manip.protocols import Reader, TrainablePolicy
from sheath_manip.support.calibration import (
    episode_threshold,
    held_out_threshold,
    or_reject_all,
)
from sheath_manip.types.samples import Samples, samples_from
from sheath_manip.types.seen import Seen


@dataclass(frozen=True, eq=False)
class Evidence:
    """The recorded states that every gate is held against, as the one policy saw them."""

    calibration: Sequence[Seen]
    fresh: Sequence[Seen]
    displaced: Mapping[str, Seen]
    far: Sequence[str]
    """the displacements that lead where no expert comes"""
    visits: Sequence[Visit]
    visited: Sequence[Seen]
    """the states of `visits`"""


@dataclass(frozen=True)
class Boundary:
    """What lies on which side of a threshold."""

    false_alarm_rate: float
    """that was asked for"""
    expert_inside: float
    """share of a new expert episode's steps, mean over the episodes"""
    outside: Mapping[str, float]
    """share of the displaced states, by displacement"""


@dataclass(frozen=True)
class Errs:
    """'The policy errs here', over all states that it visits."""

    costly: float
    """AUROC of costly mistakes against all other states"""
    differs: float
    """AUROC of 'not the expert's action'"""
    costly_states: Rate
    differing_states: Rate


@dataclass(frozen=True)
class Alarm:
    """The gate as an alarm before failure."""

    auroc: float
    """of the windows before failures against failure-free ones"""
    foreseen: float
    """share of the failures foreseen by the highest threshold that disturbs no more than the
    plan's `alarm_rate` of the failure-free windows"""
    at: Mapping[str, Foresight]
    """with thresholds from the calibration episodes alone: `step` is the gate's own; `window` and
    `episode` are calibrated to alarm in the plan's `alarm_rate` of the expert's windows, or
    episodes"""


@dataclass(frozen=True)
class Offline:
    """All that is known of a gate before it takes part in the loop."""

    auroc: Mapping[str, float]
    """of new expert states against each displacement's"""
    auroc_far: float
    """against those that lead where no expert comes, together"""
    calibrated: Boundary
    """at the gate's own threshold"""
    few: Boundary
    """at thresholds from few calibration episodes, mean over the disjoint sets of so many"""
    errs: Errs
    alarm: Alarm
    thresholds: Mapping[str, float]
    """for the loop, by the false-alarm rate asked for"""


def evidence(setting: Setting, policy: TrainablePolicy, readers: Sequence[Reader]) -> Evidence:
    """Read what was recorded, and have `policy` look at it once for all `readers`."""

    def seen(samples: Samples) -> Seen:
        return look(policy, samples, readers)

    recorded = visits(setting)
    return Evidence(
        [seen(episode) for episode in setting.calibration()],
        [seen(samples_from([episode])) for episode in setting.fresh()],
        {name: seen(states) for name, states in displaced_states(setting).items()},
        [displacement.name for displacement in setting.probes.displacements if displacement.far],
        recorded,
        [seen(visit.samples) for visit in recorded],
    )


def measured(gate: FittedGate, seen: Evidence, setting: Setting) -> Offline:
    """Hold one gate against all of it."""
    plan = setting.plan
    calibration = [gate.scores_of(episode) for episode in seen.calibration]
    fresh = [gate.scores_of(episode) for episode in seen.fresh]
    displaced = {name: gate.scores_of(states) for name, states in seen.displaced.items()}
    visited = [gate.scores_of(states) for states in seen.visited]
    expert = np.concatenate(fresh)
    far = np.concatenate([np.empty(0), *(displaced[name] for name in seen.far)])
    costly = np.concatenate([visit.costly for visit in seen.visits])
    differs = np.concatenate([visit.differs for visit in seen.visits])
    on_policy = np.concatenate(visited)
    few = [
        _threshold(calibration[start : start + plan.few], plan.few_false_alarm_rate)
        for start in range(0, len(calibration) - plan.few + 1, plan.few)
    ]
    drives = [
        Drive(scores, visit.failed) for scores, visit in zip(visited, seen.visits, strict=True)
    ]
    return Offline(
        auroc={name: auroc(expert, scores) for name, scores in displaced.items()},
        auroc_far=auroc(expert, far),
        calibrated=_boundary(
            [gate.threshold], gate.config.threshold.false_alarm_rate, fresh, displaced
        ),
        few=_boundary(few, plan.few_false_alarm_rate, fresh, displaced),
        errs=Errs(
            auroc(on_policy[~costly], on_policy[costly]),
            auroc(on_policy[~differs], on_policy[differs]),
            rate_of(costly),
            rate_of(differs),
        ),
        alarm=_alarm(gate.threshold, calibration, drives, setting),
        thresholds={str(rate): _threshold(calibration, rate) for rate in plan.rates},
    )


def _boundary(
    thresholds: Sequence[float],
    false_alarm_rate: float,
    fresh: Sequence[NDArray],
    displaced: Mapping[str, NDArray],
) -> Boundary:
    def outside(scores: NDArray) -> float:
        return float(np.mean([alarms(scores, threshold).mean() for threshold in thresholds]))

    return Boundary(
        false_alarm_rate,
        1 - float(np.mean([outside(scores) for scores in fresh])),
        {name: outside(scores) for name, scores in displaced.items()},
    )


def _alarm(
    threshold: float, calibration: Sequence[NDArray], drives: Sequence[Drive], setting: Setting
) -> Alarm:
    plan = setting.plan
    windows = [window_scores(scores, plan.window) for scores in calibration]
    # So few episodes cannot promise less than one alarm in all of them and one more.
    episode_rate = max(plan.alarm_rate, 1 / (len(calibration) + 1))
    thresholds = {
        "step": threshold,
        "window": _threshold(windows, plan.alarm_rate),
        "episode": or_reject_all(lambda: episode_threshold(calibration, episode_rate)),
    }
    before = before_failure(drives, plan.window)
    free = failure_free(drives, plan.window, plan.spared)
    return Alarm(
        auroc(free, before),
        float(detected(free, before, np.array([plan.alarm_rate]))[0]),
        {
            name: foresight(drives, value, plan.window, plan.spared)
            for name, value in thresholds.items()
        },
    )


def _threshold(scores_by_episode: Sequence[NDArray], rate: float) -> float:
    return or_reject_all(lambda: held_out_threshold(scores_by_episode, rate))
