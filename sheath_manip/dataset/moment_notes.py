"""The moments of a store's episodes, noted beside them once, so that a wall of them opens none.

As the index, the notes are never trusted over the episodes: each tells which file the episode was.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path

from sheath_manip.dataset.archive import Signature
from sheath_manip.dataset.moments import EpisodeMoments, moments_from_json, moments_to_json
from sheath_manip.dataset.noted_lines import NotedLines
from sheath_manip.dataset.places import Listed
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.exceptions import StoreError

NOTES = "sheath-moments.jsonl"
MOST_NOTES_BYTES = 256 << 20
_SCHEMA = 1
"""Raise it whenever other moments are found in the same episode."""
_BATCH = 100
"""episodes that are noted at once: who closes the page early loses no more"""
_FEW = 64
"""notes that no longer count, for which the file is not written anew"""

_Noted = tuple[Signature, EpisodeMoments]
Told = tuple[str, EpisodeMoments | StoreError]
"""the name of an episode, and its moments or why they cannot be read"""


def all_moments(reader: EpisodeReader) -> Iterator[Told]:
    """Yield the name of each episode and its moments, or what is wrong with it, in any order.

    What a directory of this machine has noted comes first, and is not opened; the rest is read, and
    noted there. Raises StoreError where the store cannot be listed.
    """
    if reader.folder is None:
        yield from _read_each(reader, reader.names())
        return
    try:
        listed = Listed.of(reader.folder)
    except OSError as error:
        raise StoreError(f"cannot list {reader.folder} ({error})") from error
    yield from _Notes(reader.folder).of(listed, reader)


def _read_each(reader: EpisodeReader, names: Iterable[str]) -> Iterator[Told]:
    for name in names:
        try:
            yield name, reader.moments(name)
        except StoreError as error:
            yield name, error


class _Notes:
    """The notes in a store's directory; nothing that goes wrong with them is raised."""

    def __init__(self, store: Path) -> None:
        self._lines = NotedLines(store, NOTES, MOST_NOTES_BYTES)

    def of(self, listed: Listed, reader: EpisodeReader) -> Iterator[Told]:
        noted = self._read()
        known = {
            name: noted[name]
            for name, at in listed.episodes.items()
            if name in noted and noted[name][0] == at
        }
        if self._lines.count > 2 * len(known) + _FEW:
            self._lines.write(_line(name, *each) for name, each in known.items())
        yield from ((name, moments) for name, (_, moments) in known.items())
        waiting = dict[str, _Noted]()
        try:
            for name, moments in _read_each(reader, sorted(listed.episodes.keys() - known.keys())):
                at = listed.episodes[name]
                # A folder's files may change without it.
                if at is not None and isinstance(moments, EpisodeMoments):
                    waiting[name] = at, moments
                if len(waiting) >= _BATCH:
                    self._add(waiting)
                yield name, moments
        finally:
            self._add(waiting)

    def _add(self, waiting: dict[str, _Noted]) -> None:
        if waiting:
            lines = [_line(name, *each) for name, each in waiting.items()]
            self._lines.add(lambda _: lines)
            waiting.clear()

    def _read(self) -> dict[str, _Noted]:
        found = dict[str, _Noted]()
        for told in self._lines.read():
            try:
                schema, name, place, moments = told
                if schema == _SCHEMA:
                    found[name] = Signature(*place), moments_from_json(moments)
            # A line that is whole may still be another version's, or anybody's.
            except (ValueError, KeyError, TypeError):
                continue
        return found


def _line(name: str, at: Signature, moments: EpisodeMoments) -> list[object]:
    return [_SCHEMA, name, [at.inode, at.bytes, at.changed_ns], moments_to_json(moments)]
