"""`sheath experiment gates`: every gate on every task that has probes, resumable."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from rich.console import Console

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.experiments.gates.figures import draw
from sheath_manip.experiments.gates.jobs import stages
from sheath_manip.experiments.gates.plan import GatesPlan
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.experiments.gates.summary import summarise
from sheath_manip.experiments.gates.table import tables
from sheath_manip.experiments.progress import Stopwatch, shown_progress
from sheath_manip.experiments.revisions import note_revision
from sheath_manip.experiments.study import Study
from sheath_manip.experiments.workers import in_stages, run_jobs
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.resuming import require_same_plan, without_seeds
from sheath_manip.rollout.executing import TWO, Executing


def run_gates(
    studies: Iterable[Study],
    plan: GatesPlan,
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
    probed = {study.name: study for study in studies if study.probes is not None}
    if not probed:
        raise ParameterError("no task has probes to test gates with; wanted at least one")
    for name in plan.tasks or ():
        if name not in probed:
            raise UnknownNameError("task with probes", name, probed)
    settings = [
        Setting(probed[name], plan, runs / name, seed)
        for name in plan.tasks or probed
        for seed in plan.seeds
    ]
    for at in settings:
        settings_held = {**plan.settings(), "learning_plan": without_seeds(at.learning)}
        require_same_plan(settings_held, at.runs / "plan.json")
        EpisodeStore.create(at.runs / "store")
    git, stopwatch = note_revision(runs), Stopwatch(runs / "wall.json")
    jobs = stages(settings)
    units = sum(job.units() for stage in jobs for job in stage)
    with shown_progress(console, units, stopwatch) as report:
        run_jobs(*in_stages(jobs), executing, report)
    summary = {**summarise(settings, plan, command, stopwatch.tick(force=True)), "git": git}
    write_json(results / "summary.json", summary)
    paths = draw(summary, results)
    console.print(tables(summary))
    for path in (results / "summary.json", *paths):
        console.print(f"  {path}")
    return summary
