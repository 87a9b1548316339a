"""Options that `sheath experiment` has for a task's methods and for a benchmark alike."""

import os
from dataclasses import dataclass
from pathlib import Path

from sheath_manip.cli.options import TaskName
from sheath_manip.exceptions import ParameterError

WORKERS = 2
"""by default: each holds its training seed's images in RAM"""


@dataclass(frozen=True, kw_only=True)
class Comparing:
    """Which experiment, how large, and where it lies."""

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
    """processes; at most 2 by default"""

    @property
    def size(self) -> str:
        """Name of the plan."""
        return "quick" if self.quick else self.plan

    def directories(self) -> tuple[Path, Path]:
        """For the runs and for the results; those of another plan keep apart from the full one."""
        full = self.size == "full"
        name = self.task if full else f"{self.task}-{self.size}"
        runs = self.runs or Path("runs") / name
        return runs, self.out or (Path("results") / name if full else runs / "results")

    def processes(self) -> int:
        """How many workers; raises ParameterError for fewer than none."""
        if self.workers is not None and self.workers < 0:
            raise ParameterError(f"workers is {self.workers}; wanted at least 0")
        return min(WORKERS, os.cpu_count() or 1) if self.workers is None else self.workers
