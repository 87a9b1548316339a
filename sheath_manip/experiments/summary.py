"""An experiment as one JSON document: what every method did, with intervals."""

import dataclasses
import math
import subprocess
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.burden import burden_of
from sheath_manip.experiments.areas import areas
from sheath_manip.files.json_files import plain
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.pooled import Field, episodes_of, figures_of_runs
from sheath_manip.learning.results import RoundResult
from sheath_manip.metrics import EpisodeRecord, expert_share, figures_of
from sheath_manip.rollout.device import computes_on
from sheath_manip.rollout.threads import THREADS

CHECKOUT = Path(__file__).resolve().parents[2]
"""the folder that holds the package: a git checkout, or site-packages, which is none"""
TALK = "talk.png"
"""the figure that says the most important thing alone"""


def summarise(
    task_name: str,
    plan: LearningPlan,
    results: Mapping[str, Sequence[RoundResult]],
    expert_records: Sequence[EpisodeRecord],
    command: str,
    wall_s: float,
    metric: str | None = None,
    references: Mapping[str, Any] | None = None,
    control_rate_hz: float | None = None,
) -> dict[str, Any]:
    """Return everything that an experiment showed, as plain values that JSON keeps.

    Null stands for NaN.

    Args:
        task_name: becomes the experiment's name.
        plan: its settings.
        results: by method, the rounds of all training seeds in any order, round 0 included.
        expert_records: of all episodes that the expert drove alone.
        command: that runs the experiment again.
        wall_s: what it took.
        metric: `TaskSpec.metric`; the first one of the expert's episodes where it is not given.
        references: figures on the final scenes of those who learn nothing, by name.
        control_rate_hz: of the task.
    """
    expert = _figures(expert_records)
    metric = metric or next(iter(expert["metric"]), None)
    by_method = {name: _method(rounds) for name, rounds in results.items()}
    for name, area in areas(results, metric).items() if metric else ():
        by_method[name]["area"] = area
    return plain(
        {
            "experiment": task_name,
            "command": command,
            **program(),
            "seeds": plan.comparison.seeds,
            "wall_s": round(wall_s, 1),
            "plan": plan.described(),
            "metric": metric,
            "control_rate_hz": control_rate_hz,
            "talk": TALK,
            "expert": expert,
            "references": references or {},
            "methods": by_method,
        }
    )


def program() -> dict[str, Any]:
    """Return what must be equal for the same command to give the same result to the bit.

    `git` is None where an installed wheel ran, `version` where nothing is installed; `threads` are
    those of torch and BLAS, and `device` is what policies and gates compute on.
    """
    try:
        version = metadata.version("sheath-manip")
    except metadata.PackageNotFoundError:
        version = None
    return {
        "git": git_revision(),
        "version": version,
        "threads": THREADS,
        "device": computes_on(),
    }


def git_revision(root: Path = CHECKOUT) -> str | None:
    """The short hash of the commit that ran, with "-dirty" where files differ; None without git."""
    if not (root / ".git").exists():
        return None
    # The experiment itself writes into results/, which makes it no other program.
    changes = ("status", "--porcelain", "--", ".", ":(exclude)results")
    try:
        revision, changed = (
            subprocess.run(
                ("git", "-C", str(root), *arguments), capture_output=True, text=True, check=True
            ).stdout.strip()
            for arguments in (("rev-parse", "--short", "HEAD"), changes)
        )
    except (OSError, subprocess.CalledProcessError):
        return None
    return f"{revision}-dirty" if changed else revision


def _method(results: Sequence[RoundResult]) -> dict[str, Any]:
    numbers = sorted({result.round for result in results})
    learning = [result for result in results if result.round > 0]
    return {
        "rounds": [
            {"round": number, **_round([result for result in results if result.round == number])}
            for number in numbers
        ],
        # Over rounds 1 and up and all seeds; queries are a training run's total.
        "overall": {**_of_runs(learning, "executed"), **_burden(learning)},
        "final": _of_runs(results, "final"),
    }


def _round(results: Sequence[RoundResult]) -> dict[str, Any]:
    """One round over all seeds: episodes are pooled, what is measured once a seed is averaged."""
    bounds = [result.bound for result in results]
    return {
        "runs": len(results),
        "executed": _of_runs(results, "executed"),
        "policy": _of_runs(results, "policy"),
        **_burden(results),
        "missed_rate": _average(result.missed_rate for result in results),
        "surrogate_loss": _average(result.surrogate_loss for result in results),
        "horizon": _average(bound.horizon for bound in bounds),
        "epsilon": _average(bound.epsilon for bound in bounds),
        "xi": _average(bound.xi for bound in bounds),
        "bound": _average(bound.value for bound in bounds),
        "measured": _average(bound.measured for bound in bounds),
        "threshold": _average(result.threshold for result in results),
        "states": _average(result.states for result in results),
    }


def _burden(results: Sequence[RoundResult]) -> dict[str, float]:
    """What the expert had to do; queries are those of one training run, averaged over the seeds."""
    records = episodes_of(results, "executed")
    runs = len({result.run_seed for result in results})
    return {
        "expert_share": expert_share(records),
        "queries": sum(record.queries for record in records) / runs if runs else math.nan,
        **dataclasses.asdict(burden_of(records)),
        "false_alarm_rate": _average(result.false_alarm_rate for result in results),
    }


def _figures(records: Sequence[EpisodeRecord]) -> dict[str, Any]:
    return dataclasses.asdict(figures_of(records))


def _of_runs(results: Sequence[RoundResult], field: Field) -> dict[str, Any]:
    return dataclasses.asdict(figures_of_runs(results, field))


def _average(values: Any) -> float:
    """The mean of those that are numbers: in a round without labels some measures are none."""
    array = np.array(list(values), dtype=float)
    array = array[~np.isnan(array)]
    return float(array.mean()) if array.size else math.nan
