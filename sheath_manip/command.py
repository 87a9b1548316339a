"""The command `sheath`: hands the tables of tasks and studies to the core, which knows none."""

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from sheath_manip.rollout.threads import one_thread_by_default

if TYPE_CHECKING:
    from sheath_manip.cli.session import Catalog


def main(argv: Sequence[str] | None = None) -> int:
    """Run `sheath` with `argv`; return its exit code."""
    one_thread_by_default()
    # Only now: it imports numpy.
    from sheath_manip.cli.entry import run_command

    return run_command(load_catalog, sys.argv[1:] if argv is None else argv)


def task_main(task: str, argv: Sequence[str] | None = None) -> int:
    """Run `python -m sheath_manip.tasks.TASK`, the verbs for this task; return the exit code."""
    one_thread_by_default()
    from sheath_manip.cli.entry import run_task_command

    return run_task_command(load_catalog, task, sys.argv[1:] if argv is None else argv)


def load_catalog() -> "Catalog":
    """Import and return the tables of tasks and studies.

    Raises SetupError where the machine lacks their simulator, or the GL library that it wants.
    """
    from sheath_manip.cli.doctor import require_simulator
    from sheath_manip.cli.gl import require_gl

    require_simulator()
    require_gl()
    # Only now: without its GL library MuJoCo cannot be imported, and `sheath doctor` must run.
    from sheath_manip.cli.session import Catalog
    from sheath_manip.tasks.table import STUDIES, TASKS

    return Catalog(TASKS, STUDIES)
