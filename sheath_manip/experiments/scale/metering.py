"""Measures the pieces of a small run of rounds: CPU seconds an episode, a fit, a measuring."""

import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.protocols import Listener, Report
from sheath_manip.rollout.executor import unheard
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.types import Episode, EpisodeInfo, Purpose


@dataclass(frozen=True)
class EpisodeCost:
    """What one episode took."""

    info: EpisodeInfo
    cpu_s: float
    size_b: int
    """of all that it holds, images included, as it is in memory"""


@dataclass(frozen=True)
class Mark:
    """When something was reached, by a clock that stands still while episodes run."""

    word: str
    at_s: float


class MeteredExecutor(SerialExecutor):
    """Runs episodes in this process, and notes the CPU seconds in them and between them."""

    def __init__(self) -> None:
        super().__init__()
        self.episodes: list[EpisodeCost] = []
        self.marks: list[Mark] = []
        self._in_episodes_s = 0.0

    def map(
        self,
        requests: Iterable[EpisodeRequest],
        store: EpisodeStore | None = None,
        listeners: Sequence[Listener] = (),
        report: Report = unheard,
    ) -> Iterator[Episode]:
        """Run each episode, or read it where the store has it, in the order of the requests."""
        asked = list(requests)
        if asked and asked[0].info.purpose is Purpose.LEARNING:
            self.mark(f"{asked[0].info.method} round {asked[0].info.round}")
        episodes = super().map(asked, store, listeners, report)
        for request in asked:
            known = store is not None and store.has(request.info)
            begin_s = time.process_time()
            episode = next(episodes)
            cpu_s = time.process_time() - begin_s
            if not known:
                self._in_episodes_s += cpu_s
                self.episodes.append(EpisodeCost(request.info, cpu_s, size_of(episode)))
            yield episode
        # To its end: the last one is on the disk then.
        for _ in episodes:
            raise AssertionError("more episodes than requests")

    def mark(self, word: str) -> None:
        """Note that something was reached; also a `Report`."""
        self.marks.append(Mark(word, time.process_time() - self._in_episodes_s))


def size_of(episode: Episode) -> int:
    """Return the bytes of an episode's images, features and states."""
    observations = [*(step.observation for step in episode.steps), episode.final_observation]
    images = sum(image.nbytes for each in observations for image in each.images.values())
    features = sum(each.features.nbytes for each in observations)
    return images + features + sum(step.state.nbytes for step in episode.steps)
