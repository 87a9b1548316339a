"""The benchmark as one JSON document and one table: learning by nu, with intervals."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from rich import box
from rich.console import Group
from rich.table import Table

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.endings import HEADINGS, ending_cells
from sheath_manip.experiments.nu.plan import METHOD, NuPlan
from sheath_manip.experiments.summary import program
from sheath_manip.experiments.summary import summarise as summarise_learning
from sheath_manip.experiments.table import seeds_shown, with_interval
from sheath_manip.files.json_files import plain
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.results import EXPERT, round_results
from sheath_manip.metrics import record_of
from sheath_manip.task import Task


@dataclass(frozen=True)
class Setting:
    """One nu on one task."""

    task: Task
    nu: float
    plan: LearningPlan
    runs: Path

    @property
    def seeds(self) -> tuple[int, ...]:
        """The seeds of the training runs."""
        return self.plan.comparison.seeds


def summarise(
    settings: Sequence[Setting], plan: NuPlan, command: str, wall_s: float
) -> dict[str, Any]:
    """Return everything that the benchmark showed, as plain values; null stands for NaN.

    Of each task: the expert's figures, and for each nu what SHEATH did with it (the shape of an
    experiment's method) and `outside`, the share of the steps met in rounds 1 and up that lay
    outside the support, where the expert acted.
    """
    tasks: dict[str, dict[str, Any]] = {}
    for at in settings:
        learned = _learned(at)
        found = tasks.setdefault(
            at.task.name,
            {
                "learning": at.plan.described(),
                "metric": learned["metric"],
                "expert": learned["expert"],
                "nus": [],
            },
        )
        method = learned["methods"][METHOD]
        outside = [entry["xi"] for entry in method["rounds"] if entry["round"] > 0]
        found["nus"].append({"nu": at.nu, "outside": float(np.mean(outside)), **method})
    return plain(
        {
            "experiment": "nu",
            "command": command,
            **program(),
            "seeds": sorted({seed for at in settings for seed in at.seeds}),
            "wall_s": round(wall_s, 1),
            "plan": plan.described(),
            "talk": f"{settings[-1].task.name}-nu.png",
            "tasks": tasks,
        }
    )


def table(summary: Mapping[str, Any]) -> Group:
    """Return a table with one row a nu; fits a terminal of 80 columns."""
    return Group(*(_table(task, found) for task, found in summary["tasks"].items()))


def _learned(at: Setting) -> dict[str, Any]:
    results = [result for seed in at.seeds for result in round_results(at.runs, seed, METHOD)]
    episodes = EpisodeStore(at.runs / "store").episodes(method=EXPERT, need_images=False)
    expert = [record_of(e) for e in episodes if e.info.run_seed in at.seeds]
    return summarise_learning(at.task.name, at.plan, {METHOD: results}, expert, "", 0.0)


def _table(task: str, found: Mapping[str, Any]) -> Table:
    words = str(found["metric"]).replace("_", "\n")
    grid = Table(
        title=f"{task}: training seeds {seeds_shown(found['learning']['comparison']['seeds'])}",
        caption="ν: bound on the training states left outside · outside: share of the steps met, "
        "in the first round, the last and all · run: what was executed in all rounds · area: the "
        "policy alone, mean over all rounds · alone: the last one",
        title_justify="left",
        caption_justify="left",
        box=box.SIMPLE_HEAD,
        padding=0,
    )
    outside = ("outside\nfirst\n%", "\nlast\n%", "\nall\n%")
    run = (f"run:\n{HEADINGS['succeeded']}", *(f"\n{HEADINGS[w]}" for w in ("failed", "stuck")))
    for header in ("\nν", *outside, *run, f"run:\n{words}", f"area\n{words}", f"alone\n{words}"):
        grid.add_column(header, justify="right", vertical="top")
    for row in found["nus"]:
        first, last = row["rounds"][1], row["rounds"][-1]
        grid.add_row(
            f"{row['nu']:g}",
            *(f"{100 * share:.1f}" for share in (first["xi"], last["xi"], row["outside"])),
            *ending_cells(row["overall"]),
            _number(row["overall"], found["metric"]),
            with_interval(row["area"]["policy"]["mean"], row["area"]["policy"]["ci95"]),
            _number(last["policy"], found["metric"]),
        )
    return grid


def _number(figures: Mapping[str, Any], metric: str) -> str:
    return with_interval(figures["metric"][metric], figures["ci95"][metric])
