"""The command `sheath`: hands the tables of tasks and studies to the core, which knows none."""

import sys
from collections.abc import Sequence

from sheath_manip.cli.doctor import require_gl
from sheath_manip.cli.entry import run_command, run_task_command
from sheath_manip.cli.session import Catalog


def main(argv: Sequence[str] | None = None) -> int:
    """Run `sheath` with `argv`; return its exit code."""
    return run_command(load_catalog, sys.argv[1:] if argv is None else argv)


def task_main(task: str, argv: Sequence[str] | None = None) -> int:
    """Run `python -m tasks.TASK`, the same verbs for this task; return the exit code."""
    return run_task_command(load_catalog, task, sys.argv[1:] if argv is None else argv)


def load_catalog() -> Catalog:
    """Return the tables of tasks and studies.

    Raises SetupError where the machine lacks the GL library that MuJoCo wants.
    """
    require_gl()
    # Only now: without its GL library MuJoCo cannot be imported, and `sheath doctor` must run.
    from sheath_manip.tasks.table import STUDIES, TASKS

    return Catalog(TASKS, STUDIES)
