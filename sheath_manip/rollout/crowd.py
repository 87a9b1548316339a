"""Workers and who of them runs what, wherever they are; one that is lost is replaced."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Protocol

from sheath_manip.dataset.naming import episode_name
from sheath_manip.exceptions import ParameterError, WorkerError
from sheath_manip.rollout.worker import Answer, Errand

MOST_TRIES = 3
"""of an episode whose worker was lost: one that kills every worker is not to be had"""


class LostWorkerError(Exception):
    """A worker is no more; says what became of it."""


class Worker(Protocol):
    """Runs errands somewhere else, one after the other."""

    def begin(self) -> None:
        """Wait until it is there; raises LostWorkerError, also where another thread calls `end`.

        Elsewhere it may be long in coming, or never come: it is given nothing before.
        """
        ...

    def run(self, errand: Errand) -> Answer:
        """Run it and wait; raises LostWorkerError, also where another thread calls `end`."""
        ...

    def end(self) -> None:
        """End it, whatever it is at."""
        ...


@dataclass(eq=False)
class Ticket:
    """An errand on its way."""

    errand: Errand
    place: int
    """among those that were asked for together"""
    answers: "SimpleQueue[tuple[int, Answer]]"
    """where its answer goes, with its place"""
    tries: int = 0

    @property
    def name(self) -> str:
        """The name of the episode."""
        return episode_name(self.errand.request.info)

    @property
    def recorded(self) -> bool:
        """Whether the episode is kept in a store."""
        return self.errand.store is not None

    @property
    def scene(self) -> tuple[object, ...]:
        """What a worker that ran another one of the same need not make anew."""
        request = self.errand.request
        return request.task.name, request.info.variant, request.info.run_seed, request.driver

    def answer(self, answer: Answer) -> None:
        """Give the answer to the one that asked."""
        self.answers.put((self.place, answer))


class Crowd:
    """So many workers, hired as they are needed, each with a thread that hands errands to it."""

    def __init__(self, workers: int, hire: Callable[[], Worker]) -> None:
        """Store how many and how to hire one; ParameterError for less than one."""
        if workers < 1:
            raise ParameterError(f"workers is {workers}; wanted at least 1")
        self.workers = workers
        self._hire = hire
        self._changed = threading.Condition()
        # All below only under that lock.
        self._pending: list[Ticket] = []
        self._hired: list[Worker] = []
        self._threads: list[threading.Thread] = []
        self._idle = 0
        self._closing = False

    def submit(self, tickets: Sequence[Ticket]) -> None:
        """Have all of them run; raises ParameterError once closed."""
        with self._changed:
            if self._closing:
                raise ParameterError("the executor is closed; wanted an open one")
            # Recorded ones first, each kind in the order of asking.
            self._pending = sorted((*self._pending, *tickets), key=lambda each: not each.recorded)
            missing = min(len(self._pending) - self._idle, self.workers - len(self._threads))
            for _ in range(missing):
                self._idle += 1
                self._threads.append(threading.Thread(target=self._employ, daemon=True))
                self._threads[-1].start()
            self._changed.notify_all()

    def close(self) -> None:
        """End the workers, whatever they are at."""
        self._shut("the executor was closed")
        for thread in self._threads:
            thread.join()

    @property
    def hired(self) -> list[Worker]:
        """The workers that there are now."""
        with self._changed:
            return list(self._hired)

    def _shut(self, why: str) -> None:
        with self._changed:
            self._closing = True
            for worker in self._hired:
                worker.end()
            for ticket in self._pending:
                ticket.answer(_not_run(ticket, why))
            self._pending.clear()
            self._changed.notify_all()

    # What follows runs in a thread of its own for each worker.

    def _employ(self) -> None:
        worker, last = None, ()
        try:
            while True:
                worker = worker or self._new()
                ticket = self._next(last)
                if ticket is None:
                    return
                last = ticket.scene
                try:
                    ticket.answer(worker.run(ticket.errand))
                except LostWorkerError as lost:
                    self._dismiss(worker)
                    worker = None
                    self._again(ticket, lost)
                with self._changed:
                    self._idle += 1
        except Exception as error:
            # Those who wait for an answer would wait for ever.
            self._shut(f"no worker can be had ({error})")
        finally:
            if worker is not None:
                self._dismiss(worker)

    def _new(self) -> Worker:
        for tries in range(1, MOST_TRIES + 1):
            worker = self._hire()
            with self._changed:
                self._hired.append(worker)
                if self._closing:
                    worker.end()
            try:
                worker.begin()
                return worker
            except LostWorkerError as lost:
                self._dismiss(worker)
                if tries == MOST_TRIES or self._closing:
                    raise WorkerError(
                        f"{tries} were lost as they started, the last {lost}"
                    ) from lost
        raise AssertionError

    def _dismiss(self, worker: Worker) -> None:
        with self._changed:
            self._hired.remove(worker)
        worker.end()

    def _next(self, last: tuple[object, ...]) -> Ticket | None:
        """The first of its kind that goes on with the `last` scene, else the first; or None."""
        with self._changed:
            self._changed.wait_for(lambda: self._pending or self._closing)
            if self._closing:
                return None
            first = self._pending[0]
            alike = (
                each
                for each in self._pending
                if each.recorded is first.recorded and each.scene == last
            )
            ticket = next(alike, first)
            self._pending.remove(ticket)
            self._idle -= 1
            return ticket

    def _again(self, ticket: Ticket, lost: LostWorkerError) -> None:
        """Let another one run the episode of a worker that is lost."""
        ticket.tries += 1
        with self._changed:
            if self._closing:
                ticket.answer(_not_run(ticket, "the executor was closed"))
            elif ticket.tries < MOST_TRIES:
                self._pending.insert(0, ticket)
                self._changed.notify()
            else:
                fault = WorkerError(
                    f"{ticket.name} lost {MOST_TRIES} workers, the last {lost}; wanted one that "
                    "comes to its end: is there memory enough?"
                )
                ticket.answer(Answer(fault=fault))


def _not_run(ticket: Ticket, why: str) -> Answer:
    return Answer(fault=WorkerError(f"{ticket.name} was not run: {why}"))
