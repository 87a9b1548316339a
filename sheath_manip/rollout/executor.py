"""What runs episodes that are asked for as values."""

from collections.abc import Iterable, Iterator, Sequence
from typing import ClassVar, Protocol

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.protocols import Listener, Report
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.types import Episode


def unheard(word: str) -> None:
    """Take a report that nobody wants."""


class Executor(Protocol):
    """Runs requests; the same ones give the same bytes in the store, wherever they run."""

    overlaps: ClassVar[bool]
    """whether requests run from when `map` is called, beside those of later calls; else each runs
    when its episode is asked for"""

    def map(
        self,
        requests: Iterable[EpisodeRequest],
        store: EpisodeStore | None = None,
        listeners: Sequence[Listener] = (),
        report: Report = unheard,
    ) -> Iterator[Episode]:
        """Run each episode, or read it where the store has it, in the order of the requests.

        Args:
            requests: what is asked for.
            store: where episodes are recorded; once all were given, all are on the disk. Without
                one an executor may leave the images out of the episodes that it gives.
            listeners: follow each episode step by step, where the executor runs in this process.
            report: is told of each episode.
        """
        ...

    def close(self) -> None:
        """End what runs, and free what it holds."""
        ...
