"""Worker processes and who of them runs what; one that is lost is replaced."""

import multiprocessing
import queue
import threading
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection, wait
from multiprocessing.context import SpawnProcess

from sheath_manip.dataset.naming import episode_name
from sheath_manip.exceptions import ParameterError, WorkerError
from sheath_manip.rollout.interrupts import deaf_children
from sheath_manip.rollout.worker import Answer, Errand, serve

MOST_TRIES = 3
"""of an episode whose worker was lost: one that kills every worker is not to be had"""


@dataclass(eq=False)
class Ticket:
    """An errand on its way."""

    errand: Errand
    answers: "queue.Queue[tuple[Ticket, Answer]]"
    """where its answer goes"""
    tries: int = 0

    @property
    def name(self) -> str:
        """The name of the episode."""
        return episode_name(self.errand.request.info)

    @property
    def recorded(self) -> bool:
        """Whether the episode is kept in a store."""
        return self.errand.store is not None


@dataclass(eq=False)
class _Worker:
    process: SpawnProcess
    connection: Connection
    ticket: Ticket | None = None
    place: tuple[object, ...] = field(default=())
    """of the environment that it has"""


class Crowd:
    """So many workers, started as they are needed, and a thread that hands errands out to them."""

    def __init__(self, workers: int) -> None:
        """Store how many; ParameterError for less than one."""
        if workers < 1:
            raise ParameterError(f"workers is {workers}; wanted at least 1")
        self.workers = workers
        # Spawned, not forked: neither torch's threads nor a GL context survive a fork.
        self._context = multiprocessing.get_context("spawn")
        self._lock = threading.Lock()
        self._pending: deque[Ticket] = deque()
        self._woken, self._wake = self._context.Pipe(duplex=False)
        self._hired: list[_Worker] = []
        self._closing = False
        self._thread: threading.Thread | None = None

    def submit(self, tickets: Sequence[Ticket]) -> None:
        """Have all of them run; raises ParameterError once closed."""
        with self._lock:
            if self._closing:
                raise ParameterError("the executor is closed; wanted an open one")
            # Recorded ones first, each kind in the order of asking.
            self._pending = deque(
                sorted((*self._pending, *tickets), key=lambda each: not each.recorded)
            )
            if self._thread is None:
                self._thread = threading.Thread(target=self._dispatch, daemon=True)
                self._thread.start()
            self._wake.send(None)

    def close(self) -> None:
        """End the workers, whatever they are at."""
        with self._lock:
            thread, self._thread = self._thread, None
            if self._closing:
                return
            self._closing = True
            self._wake.send(None)
        if thread is not None:
            thread.join()

    @property
    def process_ids(self) -> list[int]:
        """The process ids of the workers that run now."""
        return [each.process.pid for each in list(self._hired) if each.process.pid is not None]

    # What follows belongs to the dispatching thread.

    def _dispatch(self) -> None:
        try:
            while not self._closing:
                self._hand_out()
                busy = {each.connection: each for each in self._hired if each.ticket is not None}
                for ready in wait([self._woken, *busy]):
                    if ready is self._woken:
                        self._woken.recv()
                    else:
                        assert isinstance(ready, Connection)
                        self._collect(busy[ready])
        finally:
            for worker in self._hired:
                worker.process.terminate()
            for worker in self._hired:
                worker.process.join()
                worker.connection.close()
            with self._lock:
                # Also where this thread fails: those who wait for an answer would wait for ever.
                self._closing = True
                begun = [each.ticket for each in self._hired if each.ticket is not None]
                unanswered, self._hired = [*begun, *self._pending], []
                self._pending.clear()
            for ticket in unanswered:
                fault = WorkerError(f"{ticket.name} was not run: the executor was closed")
                ticket.answers.put((ticket, Answer(fault=fault)))

    def _hand_out(self) -> None:
        with self._lock:
            while self._pending:
                idle = next((each for each in self._hired if each.ticket is None), None)
                if idle is None and len(self._hired) >= self.workers:
                    return
                worker = self._hire() if idle is None else idle
                worker.ticket = self._next_for(worker)
                worker.place = _place(worker.ticket)
                try:
                    worker.connection.send(worker.ticket.errand)
                except OSError:
                    self._replace(worker)
                except Exception as error:
                    # What cannot be pickled says so in many ways, before any of it is sent.
                    fault = WorkerError(
                        f"{worker.ticket.name} cannot be sent to a worker process "
                        f"({type(error).__name__}: {error}); wanted a driver and a task that can "
                        "be pickled, or a SerialExecutor"
                    )
                    ticket, worker.ticket = worker.ticket, None
                    ticket.answers.put((ticket, Answer(fault=fault)))

    def _next_for(self, worker: _Worker) -> Ticket:
        """The first of its kind that wants the environment which the worker has, else the first."""
        first = self._pending[0]
        for ticket in self._pending:
            if ticket.recorded is first.recorded and _place(ticket) == worker.place:
                self._pending.remove(ticket)
                return ticket
        return self._pending.popleft()

    def _hire(self) -> _Worker:
        ours, theirs = self._context.Pipe()
        process = self._context.Process(target=serve, args=(theirs,), daemon=True)
        with deaf_children():
            process.start()
        theirs.close()
        worker = _Worker(process, ours)
        self._hired.append(worker)
        return worker

    def _collect(self, worker: _Worker) -> None:
        ticket = worker.ticket
        assert ticket is not None
        try:
            answer: Answer = worker.connection.recv()
        except (EOFError, OSError):
            with self._lock:
                self._replace(worker)
            return
        worker.ticket = None
        ticket.answers.put((ticket, answer))

    def _replace(self, worker: _Worker) -> None:
        """Let another one run the episode of a worker that is lost."""
        ticket = worker.ticket
        assert ticket is not None
        self._hired.remove(worker)
        worker.connection.close()
        worker.process.join()
        ticket.tries += 1
        if ticket.tries < MOST_TRIES:
            self._pending.appendleft(ticket)
            return
        fault = WorkerError(
            f"{ticket.name} lost {MOST_TRIES} workers, the last with "
            f"exit code {worker.process.exitcode}; wanted one that comes to its end: is there "
            "memory enough?"
        )
        ticket.answers.put((ticket, Answer(fault=fault)))


def _place(ticket: Ticket) -> tuple[object, ...]:
    request = ticket.errand.request
    return request.task.name, request.info.variant, request.info.run_seed, request.driver
