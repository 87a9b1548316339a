"""Episodes run in several worker processes of this machine."""

import multiprocessing
import threading

from sheath_manip.dataset.naming import episode_name
from sheath_manip.exceptions import WorkerError
from sheath_manip.rollout.crowd import Crowd, LostWorkerError
from sheath_manip.rollout.elsewhere import CrowdExecutor
from sheath_manip.rollout.interrupts import deaf_children
from sheath_manip.rollout.worker import Answer, Errand, serve

_starting = threading.Lock()
"""multiprocessing starts one process at a time"""


class ProcessExecutor(CrowdExecutor):
    """Hands requests to worker processes; one that is lost costs its episode only."""

    def __init__(self, workers: int) -> None:
        """Store how many; they start with the first request. ParameterError for less than one."""
        super().__init__(Crowd(workers, ProcessWorker))


class ProcessWorker:
    """A worker process and the connection to it."""

    def __init__(self) -> None:
        """Start it."""
        # Spawned, not forked: neither torch's threads nor a GL context survive a fork.
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self.process = context.Process(target=serve, args=(theirs,), daemon=True)
        with _starting, deaf_children():
            self.process.start()
        theirs.close()

    def begin(self) -> None:
        """Do nothing: what is sent to a process waits until it has started."""

    def run(self, errand: Errand) -> Answer:
        """Run it and wait; raises LostWorkerError where the process ends before."""
        try:
            self._connection.send(errand)
            return self._connection.recv()
        except (EOFError, OSError) as error:
            self.process.join()
            raise LostWorkerError(f"with exit code {self.process.exitcode}") from error
        except Exception as error:
            # What cannot be pickled says so in many ways, before any of it is sent.
            fault = WorkerError(
                f"{episode_name(errand.request.info)} cannot be sent to a worker process "
                f"({type(error).__name__}: {error}); wanted a driver and a task that can "
                "be pickled, or a SerialExecutor"
            )
            return Answer(fault=fault)

    def end(self) -> None:
        """End the process, and with it the connection."""
        self.process.terminate()
        self.process.join()
