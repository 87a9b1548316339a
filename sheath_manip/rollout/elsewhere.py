"""Executors whose episodes run in other processes, here or on other machines."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from queue import SimpleQueue
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


class ElsewhereExecutor(Closes, ABC):
    """Hands requests on, and gives what comes back in their order.

    Which worker runs what, and when, changes nothing in an episode: its seeds are in its request.
    `map` may be called from several threads at once.
    """

    overlaps: ClassVar[bool] = True

    @abstractmethod
    def ask(self, errands: Sequence[Errand]) -> Iterator[tuple[int, Answer]]:
        """Begin all of them now; give the place of each and its answer, as they come."""

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
        asked = list(requests)
        missing = [each for each in asked if store is None or not store.has(each.info)]
        path = None if store is None else store.path
        answers = self.ask([Errand(request, path) for request in missing])
        return _in_order(asked, missing, answers, store, report)


class CrowdExecutor(ElsewhereExecutor):
    """Has a crowd of workers; one that is lost costs its episode, which is run again."""

    def __init__(self, crowd: Crowd) -> None:
        """Store the crowd, which is closed with it."""
        self._crowd = crowd

    def ask(self, errands: Sequence[Errand]) -> Iterator[tuple[int, Answer]]:
        """Begin all of them now; give the place of each and its answer, as they come."""
        answers: SimpleQueue[tuple[int, Answer]] = SimpleQueue()
        self._crowd.submit([Ticket(each, place, answers) for place, each in enumerate(errands)])
        return (answers.get() for _ in errands)

    def close(self) -> None:
        """End the workers."""
        self._crowd.close()


def _in_order(
    asked: Sequence[EpisodeRequest],
    missing: Sequence[EpisodeRequest],
    answers: Iterator[tuple[int, Answer]],
    store: EpisodeStore | None,
    report: Report,
) -> Iterator[Episode]:
    """The episodes in the requests' order, each once it is there, or where the store has it."""
    place_of = {id(request): place for place, request in enumerate(missing)}
    done: dict[int, Answer] = {}
    for request in asked:
        place = place_of.get(id(request))
        while place is not None and place not in done:
            finished, answer = next(answers)
            if answer.fault is not None:
                raise answer.fault
            done[finished] = answer
            report(_word(missing[finished]))
        if place is None:
            report(_word(request))
        if store is not None:
            yield store.read(episode_name(request.info))
        else:
            assert place is not None
            episode = done.pop(place).episode
            assert episode is not None
            yield episode


def _word(request: EpisodeRequest) -> str:
    return f"{request.info.method} round {request.info.round}"
