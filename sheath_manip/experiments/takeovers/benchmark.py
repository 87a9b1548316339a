"""`sheath experiment takeovers`: gates beside baselines of equal burden, resumable."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from rich.console import Console

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import UnknownNameError
from sheath_manip.experiments.learning import Job as Learn
from sheath_manip.experiments.progress import Stopwatch, shown_progress
from sheath_manip.experiments.revisions import note_revision
from sheath_manip.experiments.study import Study
from sheath_manip.experiments.takeovers.figures import draw
from sheath_manip.experiments.takeovers.jobs import AnyJob, stages
from sheath_manip.experiments.takeovers.plan import TakeoversPlan
from sheath_manip.experiments.takeovers.summary import shown_before, summarise
from sheath_manip.experiments.takeovers.table import tables
from sheath_manip.experiments.takeovers.watched import Watched
from sheath_manip.experiments.workers import in_stages, run_jobs
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.resuming import require_same_plan, without_seeds
from sheath_manip.rollout.executing import TWO, Executing


def run_takeovers(
    studies: Iterable[Study],
    plan: TakeoversPlan,
    *,
    runs: Path,
    results: Path,
    command: str,
    executing: Executing = TWO,
    console: Console | None = None,
) -> dict[str, Any]:
    """Run or resume the benchmark under `runs`; write summary.json and figures to `results`.

    `executing` says where episodes run. Returns the summary.
    """
    console = console or Console()
    by_name = {study.name: study for study in studies}
    for name in plan.tasks or ():
        if name not in by_name:
            raise UnknownNameError("task", name, by_name)
    policies = [
        Watched(by_name[name], of_task, runs / name, seed, rounds)
        for name in plan.tasks or by_name
        for of_task in [plan.for_task(name)]
        for seed in of_task.seeds
        for rounds in of_task.rounds
    ]
    for at in policies:
        held = {**at.plan.settings(), "learning_plan": without_seeds(at.learning)}
        require_same_plan(held, at.runs / "plan.json")
        EpisodeStore.create(at.runs / "store")
    git = {name: note_revision(runs / name) for name in plan.tasks or by_name}
    # What is asked of some tasks alone takes a time of its own.
    stopwatch = Stopwatch(runs / f"{'-'.join(['wall', *(plan.tasks or ())])}.json")
    jobs = stages(policies)
    units = sum(_units(job) for stage in jobs for job in stage)
    with shown_progress(console, units, stopwatch) as report:
        run_jobs(*in_stages(jobs), executing, report)
    file = results / "summary.json"
    wall_s = stopwatch.tick(force=True)
    summary = summarise(policies, command, git, wall_s, shown_before(file))
    write_json(file, summary)
    paths = draw(summary, results)
    console.print(tables(summary))
    for path in (file, *paths):
        console.print(f"  {path}")
    return summary


def _units(job: AnyJob) -> int:
    """How often a job reports."""
    return job.plan.units_of_run() if isinstance(job, Learn) else 1
