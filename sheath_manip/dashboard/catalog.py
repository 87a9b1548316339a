"""The episodes of stores as the replay page lists them: by place, never by a path from outside."""

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
    """Reads and marks episodes; a place is that of `sheath data list`, store after store."""

    def __init__(self, *stores: EpisodeReader) -> None:
        self.stores = stores
        self._lock = threading.Lock()
        self.changes = 0
        """how often anything was marked"""
        listed = [(store, summary) for store in stores for summary in store.infos()]
        self._summaries = [summary for _, summary in listed]
        self._sources = [(store, summary.name) for store, summary in listed]
        self._marks = [store.marks(name) for store, name in self._sources]

    def __len__(self) -> int:
        return len(self._sources)

    @property
    def summaries(self) -> list[EpisodeSummary]:
        """Summaries of the episodes, marks included."""
        with self._lock:
            return list(self._summaries)

    @property
    def outcomes(self) -> Mapping[Outcome, int]:
        """The number of episodes that ended in each outcome."""
        return Counter(summary.outcome for summary in self.summaries)

    def source(self, place: int) -> tuple[EpisodeReader, str]:
        """Return store and name of an episode; raises ParameterError where there is none."""
        if not 0 <= place < len(self):
            raise ParameterError(
                f"there is no episode at place {place}; wanted 0 .. {len(self) - 1}"
            )
        return self._sources[place]

    def summary(self, place: int) -> EpisodeSummary:
        """The episode at a glance, marks included."""
        self.source(place)
        with self._lock:
            return self._summaries[place]

    def read(self, place: int) -> Episode:
        """The episode as it was recorded."""
        store, name = self.source(place)
        return store.read(name)

    def kept(self, place: int) -> Marks:
        """Return the marks of an episode, as this catalog knows them."""
        self.source(place)
        with self._lock:
            return self._marks[place]

    def mark(self, place: int, marks: Marks) -> None:
        """Keep what is said of it; raises StoreError where its place does not."""
        store, name = self.source(place)
        store.mark(name, marks)
        summary = store.summary(name)
        with self._lock:
            self._summaries[place] = summary
            self._marks[place] = marks
            self.changes += 1

    def scored(self, most: int) -> list[ScoredEpisode]:
        """Return the scores of the latest episodes that have any, as they were judged.

        Damaged episodes are passed over, too.
        """
        found = []
        for store, name in self._sources[-most:]:
            with suppress(StoreError):
                header = store.header(name)
                (spec,) = (each for each in layout(header) if each.path == "score")
                scores = store.array(name, spec)
                if np.isfinite(scores).any():
                    found.append(ScoredEpisode(scores, header.outcome is Outcome.FAILURE))
        return found

    def training(self) -> Samples | None:
        """Labelled states of the first episodes, without images; None where nothing is labelled.

        Damaged episodes are passed over: who looks at another one need not care.
        """
        episodes = []
        for store, name in self._sources[:MOST_STATES_OF]:
            with suppress(StoreError):
                episodes.append(store.read(name, need_images=False))
        try:
            return samples_from(episodes)
        except ParameterError:
            return None
