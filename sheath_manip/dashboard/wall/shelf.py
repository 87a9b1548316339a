"""All moments of all episodes, read once in the background, and told to the page in one answer."""

import gzip
import math
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import msgspec

from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.wall.ranking import KINDS, Moment, moments_of
from sheath_manip.dataset.moment_notes import all_moments
from sheath_manip.dataset.moments import EpisodeMoments
from sheath_manip.exceptions import StoreError

MOST_TOLD = 100_000
"""moments, the worst: a page has no use for more, and a slow line would wait for them"""
_UNREAD = EpisodeMoments()


class Shelf:
    """Reads on a thread of its own; what is there already can be asked for meanwhile."""

    def __init__(self, catalog: EpisodeCatalog) -> None:
        self._catalog = catalog
        self._found = [_UNREAD] * len(catalog)
        self._read = self._damaged = 0
        self._told: tuple[tuple[int, int], bytes] | None = None
        """what was told last, and after how much was read and marked"""
        self._closing = threading.Event()
        self._thread = threading.Thread(target=self._run, name="moments", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the thread after the episode that it is at."""
        self._closing.set()
        self._thread.join()

    def ranked(self) -> list[Moment]:
        """Return all moments that are known by now, worst first."""
        summaries, catalog = self._catalog.summaries, self._catalog
        moments = [
            moment
            for place, summary in enumerate(summaries)
            for moment in moments_of(place, summary, catalog.kept(place), self._found[place])
        ]
        return sorted(moments, key=lambda moment: moment.rank)

    def told(self) -> bytes:
        """Return all that the page needs of moments and episodes, by column, as JSON, zipped."""
        at = self._read, self._catalog.changes
        if self._told is None or self._told[0] != at:
            self._told = at, gzip.compress(self._encoded(at[0]), 1)
        return self._told[1]

    def _encoded(self, read: int) -> bytes:
        ranked = self._ranked_in_columns()
        facts = {
            "moments": ranked,
            "episodes": self._episodes(),
            "stores": [store.address for store in self._catalog.stores],
            "kinds": KINDS,
            "read": read,
            "of": len(self._found),
            "damaged": self._damaged,
        }
        # NaN, which JSON does not know, becomes null.
        return msgspec.json.encode(facts)

    def _ranked_in_columns(self) -> dict[str, Any]:
        ranked = self.ranked()[:MOST_TOLD]
        return {
            "place": [each.place for each in ranked],
            "step": [each.step for each in ranked],
            "kind": [KINDS.index(each.kind) for each in ranked],
            "margin": [None if math.isnan(each.margin) else each.margin for each in ranked],
            "reason": _coded([each.reason and each.reason.value for each in ranked]),
            "actor": _coded([each.actor and each.actor.value for each in ranked]),
            "text": {str(at): each.text for at, each in enumerate(ranked) if each.text},
        }

    def _episodes(self) -> dict[str, Any]:
        summaries, stores = self._catalog.summaries, list(self._catalog.stores)
        infos = [each.info for each in summaries]
        return {
            "name": [each.name for each in summaries],
            "store": [
                stores.index(self._catalog.source(place)[0]) for place in range(len(summaries))
            ],
            "method": _coded([info.method or info.purpose.value for info in infos]),
            "outcome": _coded([each.outcome.value for each in summaries]),
            "round": [info.round for info in infos],
            "steps": [each.length for each in summaries],
            "rate_hz": [info.control_rate_hz for info in infos],
        }

    def _run(self) -> None:
        places = dict[tuple[int, str], int]()
        stores = list(self._catalog.stores)
        for place in range(len(self._catalog)):
            store, name = self._catalog.source(place)
            places[stores.index(store), name] = place
        for number, store in enumerate(stores):
            try:
                self._take(all_moments(store), lambda name, n=number: places.get((n, name)))
            except StoreError:
                # Gone while its page is open, which says so wherever it is looked at.
                continue
        # Ready for the first one that opens the wall.
        self.told()

    def _take(
        self,
        told: Iterable[tuple[str, EpisodeMoments | StoreError]],
        place_of: Callable[[str], int | None],
    ) -> None:
        began_s = time.thread_time()
        for name, moments in told:
            if self._closing.is_set():
                return
            place = place_of(name)
            # One that was recorded since the page was opened has no place.
            if place is None:
                continue
            if isinstance(moments, EpisodeMoments):
                self._found[place] = moments
            else:
                self._damaged += 1
            self._read += 1
            # As long as it has worked, it stands aside: what plays is first.
            spent_s = time.thread_time() - began_s
            if spent_s > 0.005:
                self._closing.wait(spent_s)
                began_s = time.thread_time()


def _coded(values: Sequence[str | None]) -> dict[str, Any]:
    """Return the words that occur, and of each value its place among them; -1 for none."""
    words = list(dict.fromkeys(value for value in values if value))
    places = {word: place for place, word in enumerate(words)}
    return {"words": words, "codes": [places.get(value or "", -1) for value in values]}
