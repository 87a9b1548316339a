"""The benchmark as one JSON document: each gate beside its baselines, with intervals."""

import dataclasses
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.claims import read_summary
from sheath_manip.experiments.summary import program
from sheath_manip.experiments.takeovers.alone import Alone
from sheath_manip.experiments.takeovers.choosing import (
    read_choices,
    target_name,
    tuning_table,
)
from sheath_manip.experiments.takeovers.figures_of_trials import (
    Weighed,
    difference,
    found,
)
from sheath_manip.experiments.takeovers.jobs import (
    BASELINES,
    CHOICES,
    GATES,
    ORACLE,
)
from sheath_manip.experiments.takeovers.plan import BASELINES_OF, FRESH
from sheath_manip.experiments.takeovers.table import GATE
from sheath_manip.experiments.takeovers.trial import read_trials
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.files.json_files import plain


def summarise(
    policies: Sequence[Watched],
    command: str,
    git: Mapping[str, str | None],
    wall_s: float,
    before: Mapping[str, Any],
) -> dict[str, Any]:
    """Return everything that the benchmark showed, as plain values; null stands for NaN.

    Of each task: the run that showed it, what each policy did alone, what tuning showed, which gate
    was chosen for each target, and what gate, baselines and oracle came to on fresh scenes.

    Args:
        policies: of one or several tasks.
        command: that this run goes by.
        git: the commits that each task's run was made by, in words.
        wall_s: that this run took.
        before: what earlier runs showed of tasks, by name; kept where this run is not on them.
    """
    names = list(dict.fromkeys(at.study.name for at in policies))
    run = {"command": command, "tasks": names, "wall_s": wall_s}
    found = {
        name: {
            "run": {**run, "program": {**program(), "git": git[name]}},
            **_of_task([at for at in policies if at.study.name == name]),
        }
        for name in names
    }
    return plain({"experiment": "takeovers", "tasks": {**before, **found}})


def shown_before(path: Path) -> dict[str, Any]:
    """Return what a summary says of each task; nothing where there is no such file.

    Raises StoreError for one that is none.
    """
    if not path.exists():
        return {}
    tasks = read_summary(path).get("tasks")
    if not isinstance(tasks, dict):
        raise StoreError(f"{path} holds no result of takeovers; wanted another --out, or it gone")
    return tasks


def _of_task(policies: Sequence[Watched]) -> dict[str, Any]:
    plan, first = policies[0].plan, policies[0]
    rate_hz = first.spec().control_rate_hz
    alone = {at.name: Alone.read(at, FRESH) for at in policies}
    chosen = read_choices(first.runs / CHOICES)
    gates = _pooled(policies, alone, GATES)
    baselines = _pooled(policies, alone, BASELINES)
    oracle = _pooled(policies, alone, ORACLE)[ORACLE]
    return {
        "plan": plan.described(),
        "learning": first.learning.described(),
        "control_rate_hz": rate_hz,
        "policies": {
            name: {"episodes": each.episodes, "failing": each.failing, "stuck": each.stuck}
            for name, each in alone.items()
        },
        "tuning": {
            kind: {axis: [dataclasses.asdict(rung) for rung in of] for axis, of in axes.items()}
            for kind, axes in tuning_table(policies).items()
        },
        "kinds": [kind.name for kind in plan.kinds],
        "targets": [
            {
                "axis": axis,
                "value": value,
                "chosen": dataclasses.asdict(chosen[target_name(axis, value)]),
                "ways": _ways(axis, target_name(axis, value), gates, baselines, rate_hz),
            }
            for axis, value in plan.targets()
        ],
        "oracle": dataclasses.asdict(found(oracle, rate_hz)) if oracle else None,
    }


def _ways(
    axis: str,
    target: str,
    gates: Mapping[str, Sequence[Weighed]],
    baselines: Mapping[str, Sequence[Weighed]],
    rate_hz: float,
) -> dict[str, Any]:
    """The gate, and each baseline with the interval of how much more of the scenes it fails."""
    gate = gates[target]
    ways: dict[str, Any] = {GATE: dataclasses.asdict(found(gate, rate_hz))}
    for name in BASELINES_OF[axis]:
        trials = baselines[f"{target}/{name}"]
        pairs = [
            (ours.trial, theirs.trial)
            for ours, theirs in zip(gate, trials, strict=True)
            if ours.trial.failing
        ]
        more = difference(
            [ours.seed for ours, _ in pairs],
            np.array([ours.fails for ours, _ in pairs], float),
            np.array([theirs.fails for _, theirs in pairs], float),
        )
        ways[name] = {**dataclasses.asdict(found(trials, rate_hz)), "fails_more_ci95": more}
    return ways


def _pooled(
    policies: Sequence[Watched], alone: Mapping[str, Alone], file: str
) -> dict[str, list[Weighed]]:
    """All policies' trials on fresh scenes, by way."""
    pooled: dict[str, list[Weighed]] = {}
    for at in policies:
        of = alone[at.name]
        for way, trials in read_trials(at.trials_path(FRESH, file)).items():
            pooled.setdefault(way, []).extend(
                Weighed(trial, of.weight(trial.failing)) for trial in trials
            )
    return pooled
