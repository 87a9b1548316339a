"""One experiment: every method from every training seed, side by side, resumable, with figures."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.experiments.baselines import BaselineJob, baseline_figures, baseline_jobs
from sheath_manip.experiments.figures import FIGURES, View, write_figures
from sheath_manip.experiments.figures.replayed import pictures_of
from sheath_manip.experiments.progress import Stopwatch, shown_progress
from sheath_manip.experiments.revisions import note_revision
from sheath_manip.experiments.study import Study
from sheath_manip.experiments.summary import summarise
from sheath_manip.experiments.table import table
from sheath_manip.experiments.workers import run_jobs
from sheath_manip.files.json_files import write_json
from sheath_manip.learning.beforehand import require_learnable, with_final_variant
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.methods import method_named
from sheath_manip.learning.results import EXPERT, round_path, round_results
from sheath_manip.learning.resuming import require_same_plan
from sheath_manip.learning.run import LearningRun
from sheath_manip.metrics import record_of
from sheath_manip.protocols import Listener, Report
from sheath_manip.rollout.executing import TWO, Executing
from sheath_manip.rollout.executor import Executor
from sheath_manip.task import Task
from sheath_manip.types import Purpose

PREPARE = ""
"""stands for the method of the job that collects the demonstrations of a seed"""


@dataclass(frozen=True)
class Job:
    """One method from one training seed, in a process of its own."""

    task: Task
    plan: LearningPlan
    runs: Path
    seed: int
    method: str

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do what is not done yet."""
        learning = LearningRun(
            self.task,
            self.plan,
            self.seed,
            self.runs,
            EpisodeStore(self.runs / "store"),
            executor,
            listeners,
            report,
            # All methods are held against each other by all that the expert showed.
            failures=True,
            awaits=self.plan.rounds_are_known,
        )
        if self.method == PREPARE:
            learning.prepare()
        else:
            learning.run(self.method)


def run_experiment(
    study: Study,
    plan: LearningPlan,
    *,
    runs: Path,
    results: Path,
    command: str,
    executing: Executing = TWO,
    figures: Sequence[str] | None = None,
    listeners: Sequence[Listener] = (),
    console: Console | None = None,
) -> dict[str, Any]:
    """Run or resume the experiment under `runs`; write summary.json and figures to `results`.

    `executing` says where episodes run. Where that is this process, all runs in it, one after the
    other, and `listeners` follow it; a listener cannot follow into other processes. `figures`
    names those to draw; None means all. Returns the summary. Raises UnknownNameError before
    anything runs.
    """
    console = console or Console()
    if listeners and not executing.here:
        raise ParameterError(
            f"listeners follow one process only; wanted workers 0, but {executing}"
        )
    task = study.task
    known = (*FIGURES, *study.figures)
    for name in figures or ():
        if name not in known:
            raise UnknownNameError("figure", name, known)
    for name in plan.comparison.methods:
        follows = method_named(name).burden_from
        if follows is not None and follows not in plan.comparison.methods:
            raise ParameterError(f"method {name} follows {follows}: add {follows} to the methods")
    plan = with_final_variant(task, plan)
    _require_learnable(task, plan)
    runs.mkdir(parents=True, exist_ok=True)
    require_same_plan(plan.described(), runs / "plan.json")
    EpisodeStore.create(runs / "store")
    git, stopwatch = note_revision(runs), Stopwatch(runs / "wall.json")

    held_against = baseline_jobs(study, plan, runs)
    jobs = [
        *(Job(task, plan, runs, seed, PREPARE) for seed in plan.comparison.seeds),
        *held_against,
    ]
    units = plan.units() + plan.comparison.final_episodes * len(held_against)
    with shown_progress(console, units, stopwatch, listeners) as report:
        run_jobs(jobs, next_jobs, executing, report, listeners)
    wall_s = stopwatch.tick(force=True)
    summary = {**_summary(study, plan, runs, command, wall_s), "git": git}
    write_json(results / "summary.json", summary)
    paths = _figures(study, plan, runs, results, summary, figures)
    console.print(table(summary))
    for path in (results / "summary.json", *paths):
        console.print(f"  {path}")
    return summary


def _require_learnable(task: Task, plan: LearningPlan) -> None:
    environment = task.make_for_run(plan.schedule.variant, plan.comparison.seeds[0])
    environment.close()
    require_learnable(environment.spec, plan, plan.comparison.methods)


def next_jobs(done: Job | BaselineJob) -> list[Job]:
    """What can start after `done`: a seed's methods, each after the one that it follows, if any.

    One that follows begins beside the other, and waits for its rounds, unless these may be fewer
    than planned.
    """
    if isinstance(done, BaselineJob):
        return []
    plan = done.plan
    methods = [method_named(name) for name in plan.comparison.methods]
    wanted = None if done.method == PREPARE else done.method
    if plan.rounds_are_known:
        ready = methods if wanted is None else []
    else:
        ready = [method for method in methods if method.burden_from == wanted]
    # What others wait for goes first, and what waits last.
    followed = {method.burden_from for method in methods}
    ready = sorted(
        ready, key=lambda each: (each.burden_from is not None, each.name not in followed)
    )
    return [Job(done.task, plan, done.runs, done.seed, method.name) for method in ready]


def _summary(
    study: Study, plan: LearningPlan, runs: Path, command: str, wall_s: float
) -> dict[str, Any]:
    comparison = plan.comparison
    results = {
        name: [result for seed in comparison.seeds for result in round_results(runs, seed, name)]
        for name in comparison.methods
    }
    store = EpisodeStore(runs / "store")
    expert = [
        record_of(episode)
        for episode in store.episodes(method=EXPERT, need_images=False)
        # Failures caused by injected action noise do not count against the expert.
        if plan.schedule.demonstration_noise == 0
        or episode.info.purpose is not Purpose.DEMONSTRATION
    ]
    environment = study.task.make_for_run(plan.schedule.variant, comparison.seeds[0])
    environment.close()
    return summarise(
        study.name,
        plan,
        results,
        expert,
        command,
        wall_s,
        environment.spec.metric,
        baseline_figures(study, runs),
        environment.spec.control_rate_hz,
    )


def _figures(
    study: Study,
    plan: LearningPlan,
    runs: Path,
    results: Path,
    summary: dict[str, Any],
    names: Sequence[str] | None,
) -> list[Path]:
    task, store = study.task, EpisodeStore(runs / "store")
    methods, variant = plan.comparison.methods, plan.schedule.variant
    shown = "sheath" if "sheath" in methods else methods[0]
    last = round_results(runs, plan.comparison.seeds[0], shown)[-1]
    environment = task.make_for_run(variant, last.run_seed)
    try:
        path = round_path(runs, last.run_seed, last.method, last.round, "npz")
        checkpoint = load_checkpoint(path, environment.spec)
        own = {
            name: partial(draw, store, checkpoint, environment)
            for name, draw in study.figures.items()
        }
        view = View(pictures_of(task, variant), environment.spec.action)
        return write_figures(results, summary, store, own, names, view)
    finally:
        environment.close()
