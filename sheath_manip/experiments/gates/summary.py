"""The benchmark as one JSON document: what every gate of every task showed, with intervals."""

import dataclasses
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sheath_manip.experiments.gates.detection import Rate
from sheath_manip.experiments.gates.loop import Loop, read_loop
from sheath_manip.experiments.gates.plan import GatesPlan
from sheath_manip.experiments.gates.rows import BASELINES, EXPERT, POLICY, default_name, rows
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.experiments.summary import program
from sheath_manip.files.json_files import plain
from sheath_manip.metrics import EpisodeRecord, Figures, expert_share, figures_of

NOTICED = "noticed"
"""what the name of the figure for a talk ends in"""


@dataclass(frozen=True)
class Point:
    """One threshold in the loop."""

    false_alarm_rate: float | None
    """asked for on the calibration episodes; of random takeover the share; None where fixed"""
    expert_share: float
    queries_per_episode: float
    switches_per_episode: float
    executed: Figures


@dataclass(frozen=True)
class AtShare:
    """Values between the points nearest to the plan's share, one of which may be the policy alone
    (share 0) or the expert (1) on the same scenes: everything is interpolated, intervals too."""

    expert_share: float
    failure_rate: float
    ci95: tuple[float, float]
    """of failure_rate"""
    success_rate: float
    queries_per_episode: float
    switches_per_episode: float


@dataclass(frozen=True)
class InLoop:
    """What happened under one gate."""

    points: tuple[Point, ...]
    at_share: AtShare | None
    """None for the ends themselves"""
    learned_at: float
    """expert share of the point that was learned from"""
    final: Figures
    """the policy that learned from it, alone on held-out scenes"""


def summarise(
    settings: Sequence[Setting], plan: GatesPlan, command: str, wall_s: float
) -> dict[str, Any]:
    """Return everything that the benchmark showed, as plain values; null stands for NaN."""
    by_task: dict[str, list[Setting]] = {}
    for setting in settings:
        by_task.setdefault(setting.task.name, []).append(setting)
    return plain(
        {
            "experiment": "gates",
            "command": command,
            **program(),
            "seeds": plan.seeds,
            "wall_s": round(wall_s, 1),
            "plan": plan.described(),
            "talk": f"{settings[0].task.name}-{NOTICED}.png",
            "tasks": {name: task_summary(found) for name, found in by_task.items()},
        }
    )


def task_summary(settings: Sequence[Setting]) -> dict[str, Any]:
    """Return the summary of one task.

    The training seeds are pooled, in the loop those that took part in it.
    """
    first = settings[0]
    in_loop = [setting for setting in settings if setting.in_loop]
    listed = rows(first.plan, first.learning)
    ends = {name: _loops(in_loop, name) for name in (POLICY, EXPERT)}
    return {
        "default": default_name(listed, first.learning),
        "learning": first.learning.described(),
        "rows": {
            **{
                row.name: {
                    "embedding": row.plan.gate.embedding,
                    "support": row.plan.gate.support.name,
                    "signals": row.signals,
                    "main": row.main,
                    **_offline(offline_of(settings, row.name)),
                    "loop": dataclasses.asdict(
                        _in_loop(_loops(in_loop, row.name), ends, first.plan)
                    )
                    if first.plan.in_loop(row.main)
                    else None,
                }
                for row in listed
            },
            **{
                name: {
                    "embedding": None,
                    "support": None,
                    "signals": (),
                    "main": True,
                    "loop": dataclasses.asdict(
                        _in_loop(_loops(in_loop, name), ends, first.plan, name)
                    ),
                }
                for name in BASELINES
            },
        },
    }


def offline_of(settings: Sequence[Setting], row: str) -> dict[str, Any]:
    """The `Offline` of a row as plain values, pooled over the training seeds."""
    return pooled([json.loads(at.offline_path(row).read_text()) for at in settings])


def pooled(values: Sequence[Any]) -> Any:
    """Rates are pooled by their counts, all other numbers averaged; None where any is None."""
    first = values[0]
    if isinstance(first, Mapping):
        if {"hits", "count"} <= set(first):
            hits, count = (sum(value[key] for value in values) for key in ("hits", "count"))
            return dataclasses.asdict(Rate(hits, count))
        return {key: pooled([value[key] for value in values]) for key in first}
    if isinstance(first, list):
        return [pooled(column) for column in zip(*values, strict=True)]
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None


def _offline(offline: Mapping[str, Any]) -> dict[str, Any]:
    few, errs = offline["few"], offline["errs"]
    return {
        "auroc": offline["auroc"],
        "auroc_far": offline["auroc_far"],
        "expert_inside": offline["calibrated"]["expert_inside"],
        "far_outside": offline["calibrated"]["outside"],
        "few": {"expert_inside": few["expert_inside"], "far_outside": few["outside"]},
        "errs": errs,
        "alarm": offline["alarm"],
    }


def _loops(settings: Sequence[Setting], row: str) -> list[Loop]:
    return [read_loop(at.loop_path(row)) for at in settings]


def _in_loop(
    loops: Sequence[Loop], ends: Mapping[str, Sequence[Loop]], plan: GatesPlan, name: str = ""
) -> InLoop:
    rates = (None,) if name in ends else plan.rates
    points = tuple(
        _point(rate, [record for loop in loops for record in loop.points[number]])
        for number, rate in enumerate(rates)
    )
    # The rest of the grid meets only the first of the scenes.
    count = len(loops[0].points[0])
    low, high = (
        _point(None, [record for loop in ends[end] for record in loop.points[0][:count]])
        for end in (POLICY, EXPERT)
    )
    return InLoop(
        points,
        None if name in ends else _at_share(plan.share, [low, *points, high]),
        float(np.mean([expert_share(loop.points[loop.learned_from]) for loop in loops])),
        figures_of([record for loop in loops for record in loop.final]),
    )


def _point(rate: float | None, records: Sequence[EpisodeRecord]) -> Point:
    return Point(
        rate,
        expert_share(records),
        float(np.mean([record.queries for record in records])),
        float(np.mean([record.switches for record in records])),
        figures_of(records),
    )


def _at_share(share: float, points: Sequence[Point]) -> AtShare:
    ordered = sorted(points, key=lambda point: point.expert_share)
    shares = [point.expert_share for point in ordered]

    def at(values: Sequence[float]) -> float:
        return float(np.interp(share, shares, values))

    bounds = [point.executed.ci95["failure_rate"] for point in ordered]
    return AtShare(
        share,
        at([point.executed.failure_rate for point in ordered]),
        (at([low for low, _ in bounds]), at([high for _, high in bounds])),
        at([point.executed.success_rate for point in ordered]),
        at([point.queries_per_episode for point in ordered]),
        at([point.switches_per_episode for point in ordered]),
    )
