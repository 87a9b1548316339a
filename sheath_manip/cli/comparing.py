"""Options that `sheath experiment` has for a task's methods and for a benchmark alike."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from sheath_manip.cli.options import TaskName, default_is
from sheath_manip.exceptions import ParameterError

WORKERS = 2
"""Number of workers by default: each holds its training seed's images in RAM."""


@dataclass(frozen=True, kw_only=True)
class Comparing:
    """An experiment on the command line: which one, how large, and where it lies."""

    task: TaskName
    """name of the experiment: its task's, as `sheath tasks` lists it or a file says
    (`file.py:TASK`), or `gates`, `nu` or `takeovers`"""
    plan: str = "full"
    """name of the plan of settings, as `sheath tasks` lists it; each keeps apart from the full
    one"""
    quick: bool = False
    """the small version, in minutes: the same as --plan quick"""
    out: Annotated[Path | None, default_is("results/TASK, or beside the runs of another plan")] = (
        None
    )
    """directory for summary.json and figures"""
    runs: Annotated[Path | None, default_is("runs/TASK, or runs/TASK-PLAN for another plan")] = None
    """directory for episodes and checkpoints"""
    fresh: bool = False
    """begin anew and move aside what an earlier run left"""
    workers: Annotated[int | None, default_is("at most 2")] = None
    """number of processes"""

    @property
    def size(self) -> str:
        """Name of the plan."""
        return "quick" if self.quick else self.plan

    def directories(self, experiment: str) -> tuple[Path, Path]:
        """Return the directories for runs and for results of the experiment of that name.

        Those of another plan keep apart from the full one.
        """
        full = self.size == "full"
        name = experiment if full else f"{experiment}-{self.size}"
        runs = self.runs or Path("runs") / name
        return runs, self.out or (Path("results") / name if full else runs / "results")

    def processes(self) -> int:
        """Return the number of workers; raises ParameterError for fewer than none."""
        if self.workers is not None and self.workers < 0:
            raise ParameterError(f"workers is {self.workers}; wanted at least 0")
        return min(WORKERS, os.cpu_count() or 1) if self.workers is None else self.workers
