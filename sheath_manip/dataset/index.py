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
import os
import zlib
from collections.abc import Iterable, Mapping
from contextlib import suppress
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
from sheath_manip.dataset.rooted_files import read_inside
from sheath_manip.files.outputs import written_aside

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
        self._store = store
        self._inode, self._size = 0, 0
        """of the file that was added to last"""
        self._told = set[str]()
        """the specs that were written to that one, by their digests"""
        self._lines = 0
        """when it was read"""

    def note(self, at: Signature, summary: EpisodeSummary) -> None:
        """Add an episode that was written, or found, as the file `at`."""
        self._add([(at, summary)])

    def read(self) -> dict[str, Noted]:
        """Return what is noted of each episode, by its name: marks are not."""
        try:
            content = read_inside(self._store, INDEX, MOST_INDEX_BYTES)
        except OSError:
            content = b""
        lines = content.split(b"\n")
        specs, found = dict[str, RecordedSpec](), dict[str, Noted]()
        for line in filter(_is_whole, lines):
            try:
                _take(json.loads(line[9:]), specs, found)
            # A line that is whole may still be another version's, or anybody's.
            except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
                continue
        self._lines = len(lines)
        return found

    def bring_up(self, noted: Mapping[str, Noted], new: Iterable[str]) -> None:
        """Keep what is known of all episodes after `read`, of which those named `new` are new."""
        if self._lines > 2 * len(noted) + _FEW:
            self._write(noted.values())
        else:
            self._add(noted[name] for name in new)

    def _add(self, noted: Iterable[Noted]) -> None:
        waiting = list(noted)
        if not waiting:
            return
        with suppress(OSError):
            flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK
            descriptor = os.open(self._store / INDEX, flags, 0o644)
            try:
                status = os.fstat(descriptor)
                if status.st_ino != self._inode or status.st_size < self._size:
                    # Another file, which nothing has been told yet.
                    self._told = set()
                # What another process did not bring to its end ends here.
                text = b"\n" + b"\n".join(_lines(waiting, self._told))
                os.write(descriptor, text)
                self._inode, self._size = status.st_ino, status.st_size + len(text)
            finally:
                os.close(descriptor)

    def _write(self, noted: Iterable[Noted]) -> None:
        with suppress(OSError), written_aside(self._store / INDEX) as aside:
            aside.write_bytes(b"\n".join(_lines(noted, set())))


def _lines(noted: Iterable[Noted], told: set[str]) -> list[bytes]:
    lines = []
    for at, summary in noted:
        spec = json.dumps(spec_to_json(summary.spec), sort_keys=True)
        digest = hashlib.sha256(spec.encode()).hexdigest()[:16]
        if digest not in told:
            told.add(digest)
            lines.append(_line([_SCHEMA, digest, json.loads(spec)]))
        place = [at.inode, at.bytes, at.changed_ns]
        lines.append(_line([_SCHEMA, digest, summary.name, place, *summary_to_json(summary)]))
    return lines


def _line(told: list[Any]) -> bytes:
    text = json.dumps(told, allow_nan=False).encode()
    return f"{zlib.crc32(text):08x} ".encode() + text


def _is_whole(line: bytes) -> bool:
    return len(line) > 9 and line[:8] == f"{zlib.crc32(line[9:]):08x}".encode()


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
