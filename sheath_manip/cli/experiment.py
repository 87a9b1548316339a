"""`sheath experiment`: rounds of learning by several methods on a task, or a benchmark."""

import os
from dataclasses import dataclass, field
from pathlib import Path

from sheath_manip.cli.aside import move_aside
from sheath_manip.cli.benchmarks import BENCHMARKS, Asked
from sheath_manip.cli.options import Address, TaskName, planned, spec_of
from sheath_manip.cli.session import Session
from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.learning.config import LearningPlan
from sheath_manip.task import TaskEntry

WORKERS = 2
"""by default: each holds its training seed's images in RAM"""
OF_LEARNING = ("rounds", "methods", "figures", "dashboard", "hold")
"""options that a benchmark has no use for"""


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """Compare the methods on a task: demonstrations, rounds, held-out scenes, table and figures.

    The experiment `gates` compares gates instead, on all tasks that have probes, and `nu` the sizes
    of the support, on all tasks that have a plan for it.

    Stopped anywhere and called again, it goes on where it was.
    """

    task: TaskName
    """name of the experiment: its task's, as `sheath tasks` lists it, or `gates` or `nu`"""
    plan: str = "full"
    """the settings, as `sheath tasks` lists them; each keeps apart from the full one"""
    quick: bool = False
    """the small version, in minutes: the same as --plan quick"""
    out: Path | None = None
    """directory for summary.json and figures; results/TASK, or beside the runs of another plan"""
    runs: Path | None = None
    """directory for episodes and checkpoints; runs/TASK, or runs/TASK-PLAN for another plan"""
    fresh: bool = False
    """begin anew; what an earlier run left is moved aside"""
    workers: int | None = None
    """processes; at most 2 by default, and none but this one with --dashboard"""
    seeds: tuple[int, ...] | None = None
    """of the training runs; the plan's by default"""
    rounds: int | None = None
    """after the demonstrations; the plan's by default"""
    methods: tuple[str, ...] | None = None
    """to compare, as `sheath tasks` lists them; the plan's by default"""
    figures: tuple[str, ...] | None = None
    """file names of the figures to draw; all by default"""
    dashboard: bool = False
    """show the run in the browser"""
    hold: bool = False
    """with --dashboard: keep the page open after the end, until Ctrl-C"""
    address: Address = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Run it to its end."""
        tasks = session.tasks()
        if self.task in BENCHMARKS:
            return self._run_benchmark(session)
        if self.task not in tasks:
            raise UnknownNameError("experiment", self.task, (*tasks, *BENCHMARKS))
        task = tasks[self.task]
        plan = self._plan(task, self._size)
        workers = self._workers()
        runs, results = self._directories()
        # Only now: torch takes seconds to import.
        from sheath_manip.experiments.learning import run_experiment
        from sheath_manip.learning.methods import method_named

        for method in plan.methods:
            method_named(method)
        with self.address.listeners(self.dashboard, spec_of(task), session) as listeners:
            if self.fresh:
                move_aside(runs, session)
            run_experiment(
                task,
                plan,
                runs=runs,
                results=results,
                command=session.command,
                workers=workers,
                figures=self.figures,
                listeners=listeners,
                console=session.out,
            )
            if self.hold:
                for dashboard in listeners:
                    session.out.print("the page stays open until Ctrl-C")
                    dashboard.hold_open()
        return 0

    def _run_benchmark(self, session: Session) -> int:
        for name in OF_LEARNING:
            if getattr(self, name):
                raise ParameterError(
                    f"the experiment {self.task} takes no --{name}; "
                    "wanted --quick, --seeds, --workers, --runs, --out or --fresh"
                )
        runs, results = self._directories()
        asked = Asked(self._size, self.seeds, self._workers(), runs, results, self.fresh)
        BENCHMARKS[self.task](asked, session)
        return 0

    @property
    def _size(self) -> str:
        return "quick" if self.quick else self.plan

    def _directories(self) -> tuple[Path, Path]:
        """For the runs and for the results; those of another plan keep apart from the full one."""
        full = self._size == "full"
        name = self.task if full else f"{self.task}-{self._size}"
        runs = self.runs or Path("runs") / name
        return runs, self.out or (Path("results") / name if full else runs / "results")

    def _plan(self, task: TaskEntry, size: str) -> LearningPlan:
        for name in ("seeds", "methods", "figures"):
            if getattr(self, name) == ():
                raise ParameterError(f"{name} is empty; wanted at least one")
        return planned(task, size, seeds=self.seeds, rounds=self.rounds, methods=self.methods)

    def _workers(self) -> int:
        if self.workers is not None and self.workers < 0:
            raise ParameterError(f"workers is {self.workers}; wanted at least 0")
        if self.dashboard:
            if self.workers:
                raise ParameterError(
                    f"workers is {self.workers}; the page shows what runs in this process, "
                    "so wanted 0 (or nothing) with --dashboard"
                )
            return 0
        return min(WORKERS, os.cpu_count() or 1) if self.workers is None else self.workers
