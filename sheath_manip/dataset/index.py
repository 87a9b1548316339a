"""An index of a store's episodes, kept by whatever writes them, so that listing opens none.

It is never trusted over the episodes. Each line has a checksum, and tells of an episode which file
it was: an inode, a size and the moment of its last change, which no program can set. What does not
match the file that is there now counts for nothing, nor does a line that was cut off; such an
episode's header is read, and noted anew. Lines are only ever added, each by one call, so that any
number of processes may write at once; where half of them no longer count, a reader writes the file
anew and puts it in the place of the old one. Deleting it costs a listing its speed, once.
"""

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from sheath_manip.dataset.archive import Signature
from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.dataset.glance import (
    EpisodeSummary,
    spec_from_json,
    spec_to_json,
    summary_from_json,
    summary_to_json,
)
from sheath_manip.dataset.noted_lines import NotedLines

INDEX = "sheath-index.jsonl"
MOST_INDEX_BYTES = 256 << 20
_SCHEMA = 1
"""A line of another one counts for nothing."""
_FEW = 64
"""lines that no longer count, for which the file is not written anew"""

Noted = tuple[Signature, EpisodeSummary]


class EpisodeIndex:
    """The index in a store's directory; nothing that goes wrong with it is raised."""

    def __init__(self, store: Path) -> None:
        self._lines = NotedLines(store, INDEX, MOST_INDEX_BYTES)
        self._told = set[str]()
        """the specs that the file has, by their digests"""

    def note(self, at: Signature, summary: EpisodeSummary) -> None:
        """Add an episode that was written, or found, as the file `at`."""
        self._add([(at, summary)])

    def read(self) -> dict[str, Noted]:
        """Return what is noted of each episode, by its name: marks are not."""
        specs, found = dict[str, RecordedSpec](), dict[str, Noted]()
        for told in self._lines.read():
            try:
                _take(told, specs, found)
            # A line that is whole may still be another version's, or anybody's.
            except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
                continue
        return found

    def bring_up(self, noted: Mapping[str, Noted], new: Iterable[str]) -> None:
        """Keep what is known of all episodes after `read`, of which those named `new` are new."""
        if self._lines.count > 2 * len(noted) + _FEW:
            self._lines.write(_lines(noted.values(), set()))
        else:
            self._add(noted[name] for name in new)

    def _add(self, noted: Iterable[Noted]) -> None:
        waiting = list(noted)

        def told(is_new: bool) -> list[Any]:
            if is_new:
                self._told = set()
            return _lines(waiting, self._told)

        if waiting:
            self._lines.add(told)


def _lines(noted: Iterable[Noted], told: set[str]) -> list[Any]:
    lines = list[Any]()
    for at, summary in noted:
        spec = json.dumps(spec_to_json(summary.spec), sort_keys=True)
        digest = hashlib.sha256(spec.encode()).hexdigest()[:16]
        if digest not in told:
            told.add(digest)
            lines.append([_SCHEMA, digest, json.loads(spec)])
        place = [at.inode, at.bytes, at.changed_ns]
        lines.append([_SCHEMA, digest, summary.name, place, *summary_to_json(summary)])
    return lines


def _take(told: Any, specs: dict[str, RecordedSpec], found: dict[str, Noted]) -> None:
    """Take what a line tells; raises whatever a line that is none makes it raise."""
    schema, digest, *rest = told
    if schema != _SCHEMA:
        return
    if len(rest) == 1:
        specs[digest] = spec_from_json(rest[0])
        return
    name, place, *summary = rest
    found[name] = Signature(*place), summary_from_json(name, specs[digest], summary)
