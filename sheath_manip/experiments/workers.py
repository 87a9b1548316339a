"""An experiment's jobs, in this process or in several, and what starts after each."""

import multiprocessing
import os
import queue
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, Protocol, TypeVar

from sheath_manip.exceptions import WorkerError
from sheath_manip.protocols import Listener, Report
from sheath_manip.rollout.interrupts import deaf_children
from sheath_manip.rollout.threads import single_threaded


class Job(Protocol):
    """A piece of an experiment; it travels to a worker process and back, so keep it small."""

    def run(self, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do what is not done yet."""
        ...


AnyJob = TypeVar("AnyJob", bound=Job)


def run_jobs(
    jobs: Sequence[AnyJob],
    following: Callable[[AnyJob], Sequence[AnyJob]],
    workers: int,
    report: Report,
    listeners: Sequence[Listener] = (),
) -> None:
    """Run `jobs`, and after each the ones `following` it, in so many processes.

    With `workers` 0 all run in this process, one after the other, and `listeners` follow them.
    """
    if workers == 0:
        with single_threaded():
            _run_here(jobs, following, report, listeners)
    else:
        _run_in_processes(jobs, following, workers, report)


def in_stages(
    stages: Sequence[Sequence[AnyJob]],
) -> tuple[Sequence[AnyJob], Callable[[AnyJob], Sequence[AnyJob]]]:
    """Return the first stage for `run_jobs`, and what gives the next once one is through."""
    waiting = [list(stage) for stage in stages if stage]
    running = [len(waiting[0])] if waiting else [0]

    def following(done: AnyJob) -> Sequence[AnyJob]:
        del done
        running[0] -= 1
        if running[0] or not waiting:
            return ()
        stage = waiting.pop(0)
        running[0] = len(stage)
        return stage

    return (waiting.pop(0) if waiting else ()), following


def _run_here(
    jobs: Sequence[AnyJob],
    following: Callable[[AnyJob], Sequence[AnyJob]],
    report: Report,
    listeners: Sequence[Listener],
) -> None:
    waiting = list(jobs)
    while waiting:
        job = waiting.pop(0)
        job.run(report, listeners)
        waiting = [*following(job), *waiting]


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


def _run_job(job: AnyJob) -> AnyJob:
    with single_threaded():
        job.run(_reports.put)
    return job


def _run_in_processes(
    jobs: Sequence[AnyJob],
    following: Callable[[AnyJob], Sequence[AnyJob]],
    workers: int,
    report: Report,
) -> None:
    # Spawned, not forked: neither torch's threads nor a GL context survive a fork.
    context = multiprocessing.get_context("spawn")
    reports = context.Queue()
    stop = threading.Event()
    drain = threading.Thread(target=_drain, args=(reports, report, stop), daemon=True)
    drain.start()
    pool = ProcessPoolExecutor(workers, context, _start_worker, (reports,))

    def submitted(jobs: Sequence[AnyJob]) -> set[Future[AnyJob]]:
        # Which starts a process, while there are not so many.
        with deaf_children():
            return {pool.submit(_run_job, job) for job in jobs}

    try:
        pending = submitted(jobs)
        while pending:
            finished, pending = wait(pending, return_when=FIRST_COMPLETED)
            for future in finished:
                pending |= submitted(following(future.result()))
    except BrokenProcessPool as lost:
        raise WorkerError(
            "a worker process was lost, killed or without memory; call again to go on: what it had "
            "finished is kept"
        ) from lost
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for process in multiprocessing.active_children():
            process.terminate()
        stop.set()
        drain.join()
        reports.close()


def _drain(reports: Any, report: Report, stop: threading.Event) -> None:
    while not stop.is_set():
        try:
            report(reports.get(timeout=0.2))
        except queue.Empty:
            continue
        except (EOFError, OSError):
            return
