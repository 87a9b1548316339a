"""All episodes of a store at a glance, most of them by its index."""

from collections.abc import Iterator

from sheath_manip.dataset.glance import EpisodeSummary
from sheath_manip.dataset.index import EpisodeIndex, Noted
from sheath_manip.dataset.places import Listed
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.exceptions import StoreError


def indexed_summaries(
    reader: EpisodeReader, index: EpisodeIndex, listed: Listed
) -> Iterator[EpisodeSummary | StoreError]:
    """Yield the `listed` episodes of a store, sorted by name, or what is wrong with one's header.

    An episode is opened only where the index does not tell of the very file that is there; of what
    was opened the index tells afterwards. A folder is opened each time.
    """
    noted, known, new = index.read(), dict[str, Noted](), list[str]()
    for name in sorted(listed.episodes):
        at, held = listed.episodes[name], noted.get(name)
        try:
            if at is None:
                yield reader.summary(name)
                continue
            if held is not None and held[0] == at:
                summary = held[1]
            else:
                summary = reader.unmarked_summary(name)
                new.append(name)
            known[name] = at, summary
            yield summary.marked(reader.marks(name)) if name in listed.marked else summary
        except StoreError as error:
            yield error
    index.bring_up(known, new)
