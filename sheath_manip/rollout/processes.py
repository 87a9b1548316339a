"""Episodes run in several worker processes of this machine."""

import queue
from collections.abc import Iterable, Iterator, Sequence
from typing import ClassVar

from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Listener, Report
from sheath_manip.protocols.closing import Closes
from sheath_manip.rollout.crowd import Crowd, Ticket
from sheath_manip.rollout.executor import unheard
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.worker import Answer, Errand
from sheath_manip.types import Episode


class ProcessExecutor(Closes):
    """Hands requests to worker processes; one that is lost costs its episode, which is run again.

    Which worker runs what, and when, changes nothing in an episode: its seeds are in its request.
    `map` may be called from several threads at once.
    """

    overlaps: ClassVar[bool] = True

    def __init__(self, workers: int) -> None:
        """Store how many; they start with the first request. ParameterError for less than one."""
        self._crowd = Crowd(workers)

    def map(
        self,
        requests: Iterable[EpisodeRequest],
        store: EpisodeStore | None = None,
        listeners: Sequence[Listener] = (),
        report: Report = unheard,
    ) -> Iterator[Episode]:
        """Run each episode, or read it where the store has it; given in the requests' order.

        All begin now; those that are recorded go before those that are not, since it is their
        like that the next fit waits for. Without a store episodes come without images. Raises
        ParameterError for listeners, which cannot follow into other processes, and WorkerError
        where an episode cannot be run.
        """
        if listeners:
            raise ParameterError("listeners follow one process only; wanted a SerialExecutor")
        answers: queue.Queue[tuple[Ticket, Answer]] = queue.Queue()
        asked = list(requests)
        path = None if store is None else store.path
        tickets = [
            None
            if store is not None and store.has(request.info)
            else Ticket(Errand(request, path), answers)
            for request in asked
        ]
        self._crowd.submit([ticket for ticket in tickets if ticket is not None])
        return _answered(asked, tickets, answers, store, report)

    def close(self) -> None:
        """End the workers."""
        self._crowd.close()


def _answered(
    asked: Sequence[EpisodeRequest],
    tickets: Sequence[Ticket | None],
    answers: "queue.Queue[tuple[Ticket, Answer]]",
    store: EpisodeStore | None,
    report: Report,
) -> Iterator[Episode]:
    """The episodes in the requests' order, each once it is there; no ticket: the store has it."""
    done: dict[int, Answer] = {}
    for request, ticket in zip(asked, tickets, strict=True):
        while ticket is not None and id(ticket) not in done:
            finished, answer = answers.get()
            if answer.fault is not None:
                raise answer.fault
            done[id(finished)] = answer
            report(_word(finished.errand.request))
        if ticket is None:
            report(_word(request))
        if store is not None:
            yield store.read(episode_name(request.info))
        else:
            assert ticket is not None
            episode = done.pop(id(ticket)).episode
            assert episode is not None
            yield episode


def _word(request: EpisodeRequest) -> str:
    return f"{request.info.method} round {request.info.round}"
