"""A worker of an experiment that is lost is one line."""

import os
import signal
from collections.abc import Sequence
from dataclasses import dataclass

import pytest

from sheath_manip.exceptions import WorkerError
from sheath_manip.experiments.workers import run_jobs
from sheath_manip.protocols import Listener, Report
from sheath_manip.rollout.executing import TWO
from sheath_manip.rollout.executor import Executor


@dataclass(frozen=True)
class Deadly:
    """A job that kills its own process, as the operating system does where memory ends."""

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        del executor, report, listeners
        os.kill(os.getpid(), signal.SIGKILL)


def test_a_lost_worker_is_one_line() -> None:
    with pytest.raises(WorkerError, match=r"was lost, .* call again"):
        run_jobs([Deadly()], lambda _: [], TWO, lambda _: None)
