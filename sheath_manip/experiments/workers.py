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
from sheath_manip.rollout.executing import Executing
from sheath_manip.rollout.executor import Executor
from sheath_manip.rollout.interrupts import deaf_children
from sheath_manip.rollout.shared import Exchange, SharedExecutor
from sheath_manip.rollout.threads import single_threaded


class Job(Protocol):
    """A piece of an experiment; it travels to another process and back, so keep it small."""

    def run(self, executor: Executor, report: Report, listeners: Sequence[Listener] = ()) -> None:
        """Do what is not done yet; `executor` runs episodes, also for the jobs beside this one."""
        ...


AnyJob = TypeVar("AnyJob", bound=Job)
CORES = os.cpu_count() or 1


def run_jobs(
    jobs: Sequence[AnyJob],
    following: Callable[[AnyJob], Sequence[AnyJob]],
    executing: Executing,
    report: Report,
    listeners: Sequence[Listener] = (),
) -> None:
    """Run `jobs`, and after each the ones `following` it, side by side where episodes are.

    Each job fits and measures in a process of this machine, as many at once as there are workers
    or cores here; they share the workers that run episodes, so that none idles while one job fits.
    Where episodes run in this process all does, one after the other, and `listeners` follow.
    """
    if executing.here:
        with single_threaded(), executing.made() as executor:
            _run_here(jobs, following, executor, report, listeners)
    else:
        with executing.elsewhere() as executor, Exchange(executor) as exchange:
            most = min(executing.workers or CORES, CORES)
            _run_in_processes(jobs, following, most, exchange.address, report)


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
    executor: Executor,
    report: Report,
    listeners: Sequence[Listener],
) -> None:
    waiting = list(jobs)
    while waiting:
        job = waiting.pop(0)
        job.run(executor, report, listeners)
        waiting = [*following(job), *waiting]


_reports: Any = None
"""in a job's process: where its progress goes"""
_exchange: str = ""
"""in a job's process: where it asks for episodes"""


def _start_process(reports: Any, exchange: str) -> None:
    global _reports, _exchange
    _reports, _exchange = reports, exchange
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """A worker that outlived a killed experiment would write beside the one that resumes it."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _run_job(job: AnyJob) -> AnyJob:
    with single_threaded():
        job.run(SharedExecutor(_exchange), _reports.put)
    return job


def _run_in_processes(
    jobs: Sequence[AnyJob],
    following: Callable[[AnyJob], Sequence[AnyJob]],
    most: int,
    exchange: str,
    report: Report,
) -> None:
    # Spawned, not forked: neither torch's threads nor a GL context survive a fork.
    context = multiprocessing.get_context("spawn")
    reports = context.Queue()
    stop = threading.Event()
    drain = threading.Thread(target=_drain, args=(reports, report, stop), daemon=True)
    drain.start()
    pool = ProcessPoolExecutor(most, context, _start_process, (reports, exchange))

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
