"""One experiment: every method from every training seed, side by side, resumable, with figures."""

import json
import multiprocessing
import os
import queue
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from sheath_manip.aggregate import LearningRun
from sheath_manip.checkpoint import load_checkpoint
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.evaluation import Report
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.experiments.figures import FIGURES, write_figures
from sheath_manip.experiments.summary import summarise, table
from sheath_manip.methods import method_named
from sheath_manip.metrics import record_of
from sheath_manip.plan import LearningPlan
from sheath_manip.protocols import Listener
from sheath_manip.results import EXPERT, round_path, round_results, write_json
from sheath_manip.task import TaskEntry
from sheath_manip.threads import single_threaded

PREPARE = ""
"""stands for the method of the job that collects the demonstrations of a seed"""


@dataclass(frozen=True)
class Job:
    """One method from one training seed, in a process of its own."""

    task: TaskEntry
    plan: LearningPlan
    runs: Path
    seed: int
    method: str

    def run(self, report: Report, listeners: Sequence[Listener] = ()) -> "Job":
        """Do what is not done yet."""
        store = EpisodeStore(self.runs / "store")
        learning = LearningRun(self.task, self.plan, self.seed, self.runs, store, listeners, report)
        try:
            if self.method == PREPARE:
                learning.prepare()
            else:
                learning.run(self.method)
        finally:
            learning.close()
        return self


def run_experiment(
    task: TaskEntry,
    plan: LearningPlan,
    *,
    runs: Path,
    results: Path,
    command: str,
    workers: int = 2,
    figures: Sequence[str] | None = None,
    listeners: Sequence[Listener] = (),
    console: Console | None = None,
) -> dict[str, Any]:
    """Run or resume the experiment under `runs`; write summary.json and figures to `results`.

    With `workers` 0 all runs in this process, one after the other, and `listeners` follow it; a
    listener cannot follow into worker processes. `figures` names those to draw; None means all.
    Returns the summary. Raises UnknownNameError before anything runs.
    """
    console = console or Console()
    if listeners and workers:
        raise ParameterError(f"listeners follow one process only; wanted workers 0, got {workers}")
    known = (*FIGURES, *task.figures)
    for name in figures or ():
        if name not in known:
            raise UnknownNameError("figure", name, known)
    for name in plan.methods:
        follows = method_named(name).follows
        if follows is not None and follows not in plan.methods:
            raise ParameterError(f"method {name} follows {follows}: add {follows} to the methods")
    runs.mkdir(parents=True, exist_ok=True)
    _same_plan(plan, runs / "plan.json")
    EpisodeStore.create(runs / "store")
    stopwatch = Stopwatch(runs / "wall.json")

    columns = (
        TextColumn("{task.description:32}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=False) as progress:
        bar = progress.add_task("starting", total=plan.units())

        def report(text: str) -> None:
            progress.update(bar, advance=1, description=text)
            stopwatch.tick()

        jobs = [Job(task, plan, runs, seed, PREPARE) for seed in plan.seeds]
        if workers == 0:
            with single_threaded():
                _run_here(jobs, report, listeners)
        else:
            _run_in_processes(jobs, workers, report)
        progress.update(bar, completed=plan.units(), description="done")

    wall_s = stopwatch.tick(force=True)
    summary = _summary(task, plan, runs, command, wall_s)
    write_json(results / "summary.json", summary)
    paths = _figures(task, plan, runs, results, summary, figures)
    console.print(table(summary))
    for path in (results / "summary.json", *paths):
        console.print(f"  {path}")
    return summary


class Stopwatch:
    """Wall time of a run, over all the sessions that it took."""

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._before_s = float(json.loads(path.read_text())["wall_s"])
        except (OSError, ValueError, KeyError, TypeError):
            self._before_s = 0.0
        self._begin_s = self._written_s = time.monotonic()

    def tick(self, force: bool = False) -> float:
        """The time so far, in seconds; written every few of them, so that a kill loses little."""
        now_s = time.monotonic()
        total_s = self._before_s + now_s - self._begin_s
        if force or now_s - self._written_s > 5.0:
            write_json(self._path, {"wall_s": total_s})
            self._written_s = now_s
        return total_s


def _next_jobs(done: Job) -> list[Job]:
    """What can start after `done`: a seed's methods, then those that follow another's share."""
    plan = done.plan
    methods = [method_named(name) for name in plan.methods]
    wanted = None if done.method == PREPARE else done.method
    ready = [method.name for method in methods if method.follows == wanted]
    # What others wait for goes first.
    ready.sort(key=lambda name: all(method.follows != name for method in methods))
    return [Job(done.task, plan, done.runs, done.seed, name) for name in ready]


def _run_here(jobs: list[Job], report: Report, listeners: Sequence[Listener]) -> None:
    waiting = list(jobs)
    while waiting:
        done = waiting.pop(0).run(report, listeners)
        waiting = _next_jobs(done) + waiting


_reports: Any = None
"""in a worker process: where its progress goes"""


def _start_worker(reports: Any) -> None:
    global _reports
    _reports = reports
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A worker that outlived a killed experiment would write beside the one that resumes it."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _run_job(job: Job) -> Job:
    with single_threaded():
        return job.run(_reports.put)


def _run_in_processes(jobs: list[Job], workers: int, report: Report) -> None:
    # Spawned, not forked: neither torch's threads nor a GL context survive a fork.
    context = multiprocessing.get_context("spawn")
    reports = context.Queue()
    stop = threading.Event()
    drain = threading.Thread(target=_drain, args=(reports, report, stop), daemon=True)
    drain.start()
    pool = ProcessPoolExecutor(workers, context, _start_worker, (reports,))
    try:
        pending: set[Future[Job]] = {pool.submit(_run_job, job) for job in jobs}
        while pending:
            finished, pending = wait(pending, return_when=FIRST_COMPLETED)
            for future in finished:
                pending |= {pool.submit(_run_job, job) for job in _next_jobs(future.result())}
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()
        stop.set()
        drain.join()
        reports.close()


def _drain(reports: Any, report: Callable[[str], None], stop: threading.Event) -> None:
    while not stop.is_set():
        try:
            report(reports.get(timeout=0.2))
        except queue.Empty:
            continue
        except (EOFError, OSError):
            return


def _same_plan(plan: LearningPlan, path: Path) -> None:
    described = json.loads(json.dumps(plan.described()))
    if not path.exists():
        write_json(path, described)
        return
    held = json.loads(path.read_text())
    if held != described:
        keys = sorted(key for key in {*held, *described} if held.get(key) != described.get(key))
        raise ParameterError(
            f"{path.parent} holds a run with another {', '.join(keys)}; "
            "resume with the same settings, name another directory, or start it afresh"
        )


def _summary(
    task: TaskEntry, plan: LearningPlan, runs: Path, command: str, wall_s: float
) -> dict[str, Any]:
    results = {
        name: [result for seed in plan.seeds for result in round_results(runs, seed, name)]
        for name in plan.methods
    }
    store = EpisodeStore(runs / "store")
    expert = [record_of(e) for e in store.episodes(method=EXPERT, need_images=False)]
    return summarise(task.name, plan, results, expert, command, wall_s)


def _figures(
    task: TaskEntry,
    plan: LearningPlan,
    runs: Path,
    results: Path,
    summary: dict[str, Any],
    names: Sequence[str] | None,
) -> list[Path]:
    store = EpisodeStore(runs / "store")
    shown = "sheath" if "sheath" in plan.methods else plan.methods[0]
    last = round_results(runs, plan.seeds[0], shown)[-1]
    environment = task.make()
    try:
        path = round_path(runs, last.run_seed, last.method, last.round, "npz")
        checkpoint = load_checkpoint(path, environment.spec)
        own = {
            name: partial(draw, store, checkpoint, environment)
            for name, draw in task.figures.items()
        }
        return write_figures(results, summary, store, own, names)
    finally:
        environment.close()
