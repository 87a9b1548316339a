"""The command `sheath`: hands the tables of tasks and studies to the core, which knows none."""

import os
import signal
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from types import FrameType
from typing import TYPE_CHECKING, Any

from sheath_manip.rollout.threads import one_thread_by_default

if TYPE_CHECKING:
    from sheath_manip.adapters.task_env import TaskEnv
    from sheath_manip.cli.session import Catalog

INTERRUPTED = 130
"""the exit code after Ctrl-C"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run `sheath` with `argv`; return its exit code."""

    def run() -> int:
        from sheath_manip.cli.entry import run_command

        return run_command(load_catalog, sys.argv[1:] if argv is None else argv)

    return _run(run)


def task_main(task: str, argv: Sequence[str] | None = None) -> int:
    """Run `python -m sheath_manip.tasks.TASK`, the verbs for this task; return the exit code."""

    def run() -> int:
        from sheath_manip.cli.entry import run_task_command

        return run_task_command(load_catalog, task, sys.argv[1:] if argv is None else argv)

    return _run(run)


def load_catalog() -> "Catalog":
    """Import and return the tables of tasks and studies.

    Raises SetupError where the machine lacks their simulator.
    """
    from sheath_manip.cli.doctor import require_simulator

    require_simulator()
    # Only now: without the simulator they cannot be imported, and `sheath doctor` must run.
    from sheath_manip.cli.session import Catalog
    from sheath_manip.tasks.table import STUDIES, TASKS

    return Catalog(TASKS, STUDIES)


def task_env(task: str, **settings: Any) -> "TaskEnv":
    """Make the gymnasium environment of a task in the tables: what `gymnasium.make` calls.

    Raises SetupError where the machine lacks the simulator, and as `TaskEnv` does.
    """
    from sheath_manip.adapters.task_env import TaskEnv

    return TaskEnv(load_catalog().tasks[task], **settings)


def _run(command: Callable[[], int]) -> int:
    """Run a command, whose modules are only now imported; Ctrl-C is one line whenever it comes."""
    one_thread_by_default()
    # A command in another thread is interrupted by the code that has the main one.
    with suppress(ValueError):
        signal.signal(signal.SIGINT, _interrupt)
    try:
        return command()
    except KeyboardInterrupt:
        _say_interrupted()
        return INTERRUPTED
    finally:
        # What Python still does at its end would answer with a traceback.
        with suppress(ValueError):
            signal.signal(signal.SIGINT, _end)


def _interrupt(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, but where a module is being imported: end at once.

    An import that is interrupted may swallow it, or make another error of it.
    """
    at = frame
    while at is not None:
        if at.f_code.co_filename.startswith("<frozen importlib"):
            _end(number, frame)
        at = at.f_back
    raise KeyboardInterrupt


def _end(number: int, frame: FrameType | None) -> None:
    """End the process, as a kill would: what is recorded is whole on the disk."""
    del number, frame
    with suppress(Exception):
        sys.stdout.flush()
    _say_interrupted()
    os._exit(INTERRUPTED)


def _say_interrupted() -> None:
    with suppress(OSError):
        os.write(2, b"sheath: interrupted; what was recorded is kept\n")
