"""`sheath experiment nu`: rounds of SHEATH for each nu, on every task that offers a plan for it."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from rich.console import Console

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.learning import Job
from sheath_manip.experiments.nu.figure import draw
from sheath_manip.experiments.nu.plan import METHOD, NuPlan
from sheath_manip.experiments.nu.summary import Setting, summarise, table
from sheath_manip.experiments.progress import Stopwatch, shown_progress
from sheath_manip.experiments.revisions import note_revision
from sheath_manip.experiments.study import Study
from sheath_manip.experiments.workers import run_jobs
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.resuming import require_same_plan, without_seeds
from sheath_manip.rollout.executing import TWO, Executing


def run_nu(
    studies: Iterable[Study],
    plan: NuPlan,
    *,
    runs: Path,
    results: Path,
    command: str,
    executing: Executing = TWO,
    console: Console | None = None,
) -> dict[str, Any]:
    """Run or resume the benchmark under `runs`; write summary.json and figures to `results`.

    Each nu has its own directory, which is a run of rounds as any other. The expert's episodes in
    them are alike to the bit, since their seeds name them; recording them again takes less time
    than anything that is learned from them. Returns the summary.
    """
    console = console or Console()
    settings = [
        Setting(study.task, nu, plan.of(study, nu), runs / study.name / f"nu-{nu:g}")
        for study in studies
        if plan.learning in study.plans
        for nu in plan.nus
    ]
    if not settings:
        raise ParameterError(f"no task has a plan {plan.learning!r}; wanted at least one")
    for at in settings:
        require_same_plan(without_seeds(at.plan), at.runs / "plan.json")
        EpisodeStore.create(at.runs / "store")
    jobs = [Job(at.task, at.plan, at.runs, seed, METHOD) for at in settings for seed in at.seeds]
    git, stopwatch = note_revision(runs), Stopwatch(runs / "wall.json")
    with shown_progress(console, sum(job.plan.units_of_run() for job in jobs), stopwatch) as report:
        run_jobs(jobs, lambda _: (), executing, report)
    summary = {**summarise(settings, plan, command, stopwatch.tick(force=True)), "git": git}
    write_json(results / "summary.json", summary)
    paths = draw(summary, results)
    console.print(table(summary))
    for path in (results / "summary.json", *paths):
        console.print(f"  {path}")
    return summary
