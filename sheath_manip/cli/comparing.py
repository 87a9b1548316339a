"""Options that `sheath experiment` has for a task's methods and for a benchmark alike."""

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from sheath_manip.cli.computing import Computing
from sheath_manip.cli.options import WITHOUT_PREFIX, TaskName, default_is
from sheath_manip.cli.where import Where
from sheath_manip.rollout.executing import Executing

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
    computing: Annotated[Computing, WITHOUT_PREFIX] = field(default_factory=Computing)
    where: Annotated[Where, WITHOUT_PREFIX] = field(default_factory=Where)

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

    def executing(self) -> Executing:
        """Return where episodes run, by default in at most two workers of this machine."""
        return self.where.executing.by_default(min(WORKERS, os.cpu_count() or 1))
