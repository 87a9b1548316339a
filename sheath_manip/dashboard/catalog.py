"""The episodes of a store as the replay page lists them: by place, never by a path from outside."""

import threading
from collections import Counter
from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.reader import EpisodeReader, EpisodeSummary
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.gates.what_if import ScoredEpisode
from sheath_manip.types import Episode, Outcome
from sheath_manip.types.samples import Samples, samples_from

MOST_STATES_OF = 40
"""episodes that the picture of the support is drawn from"""


class EpisodeCatalog:
    """Reads and marks episodes of one store; a place is that of `sheath data list`."""

    def __init__(self, store: EpisodeReader) -> None:
        self._store = store
        self._lock = threading.Lock()
        self._summaries = store.infos()
        self._names = [summary.name for summary in self._summaries]
        self._marks = [store.marks(name) for name in self._names]

    def __len__(self) -> int:
        return len(self._names)

    @property
    def summaries(self) -> list[EpisodeSummary]:
        """Summaries of the episodes, marks included."""
        with self._lock:
            return list(self._summaries)

    @property
    def outcomes(self) -> Mapping[Outcome, int]:
        """The number of episodes that ended in each outcome."""
        return Counter(summary.outcome for summary in self.summaries)

    def name(self, place: int) -> str:
        """Return the name of the episode at `place`; raises ParameterError where there is none."""
        if not 0 <= place < len(self._names):
            raise ParameterError(
                f"there is no episode at place {place}; wanted 0 .. {len(self._names) - 1}"
            )
        return self._names[place]

    def summary(self, place: int) -> EpisodeSummary:
        """The episode at a glance, marks included."""
        self.name(place)
        with self._lock:
            return self._summaries[place]

    def read(self, place: int) -> Episode:
        """The episode as it was recorded."""
        return self._store.read(self.name(place))

    def kept(self, place: int) -> Marks:
        """Return the marks of an episode, as this catalog knows them."""
        self.name(place)
        with self._lock:
            return self._marks[place]

    def mark(self, place: int, marks: Marks) -> None:
        """Keep what is said of it; raises StoreError where its place does not."""
        name = self.name(place)
        self._store.mark(name, marks)
        summary = self._store.summary(name)
        with self._lock:
            self._summaries[place] = summary
            self._marks[place] = marks

    def scored(self, most: int) -> list[ScoredEpisode]:
        """Return the scores of the latest episodes that have any, as they were judged.

        Damaged episodes are passed over, too.
        """
        found = []
        for name in self._names[-most:]:
            with suppress(StoreError):
                header = self._store.header(name)
                (spec,) = (each for each in layout(header) if each.path == "score")
                scores = self._store.array(name, spec)
                if np.isfinite(scores).any():
                    found.append(ScoredEpisode(scores, header.outcome is Outcome.FAILURE))
        return found

    def training(self) -> Samples | None:
        """Labelled states of the first episodes, without images; None where nothing is labelled.

        Damaged episodes are passed over: who looks at another one need not care.
        """
        episodes = []
        for name in self._names[:MOST_STATES_OF]:
            with suppress(StoreError):
                episodes.append(self._store.read(name, need_images=False))
        try:
            return samples_from(episodes)
        except ParameterError:
            return None
