"""A file of notes beside a store's episodes: lines with checksums, which any process may add to.

What is noted can be had again from the episodes, so nothing that goes wrong with the file is
raised: a line that was cut off, or changed, is passed over.
"""

import json
import os
import zlib
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from sheath_manip.dataset.rooted_files import read_inside
from sheath_manip.files.outputs import written_aside


class NotedLines:
    """The lines of one file, each a value of JSON; deleting the file costs only time."""

    def __init__(self, folder: Path, file: str, most_bytes: int) -> None:
        self._folder, self._file, self._most_bytes = folder, file, most_bytes
        self._inode, self._size = 0, 0
        """of the file that was added to last"""
        self.count = 0
        """of lines when it was read, whole or not"""

    def read(self) -> list[Any]:
        """Return what each whole line holds, which may be another version's, or anybody's."""
        try:
            content = read_inside(self._folder, self._file, self._most_bytes)
        except OSError:
            content = b""
        lines = content.split(b"\n")
        self.count = len(lines)
        return _values([line[9:] for line in filter(_is_whole, lines)])

    def add(self, told: Callable[[bool], Iterable[Any]]) -> None:
        """Add the lines that `told` gives, by one call, so that others may add at once.

        `told` is asked with whether the file is another than the one that was added to last.
        """
        flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK
        with suppress(OSError):
            descriptor = os.open(self._folder / self._file, flags, 0o644)
            try:
                status = os.fstat(descriptor)
                is_new = status.st_ino != self._inode or status.st_size < self._size
                # What another process did not bring to its end ends here.
                text = b"\n" + b"\n".join(map(_line, told(is_new)))
                os.write(descriptor, text)
                self._inode, self._size = status.st_ino, status.st_size + len(text)
            finally:
                os.close(descriptor)

    def write(self, told: Iterable[Any]) -> None:
        """Put a file of these lines in the place of the one that is there."""
        with suppress(OSError), written_aside(self._folder / self._file) as aside:
            aside.write_bytes(b"\n".join(map(_line, told)))


def _values(texts: Sequence[bytes]) -> list[Any]:
    """What each text of JSON holds, without those that are none."""
    with suppress(ValueError, RecursionError):
        # Ten thousand episodes are listed in two thirds of the time that a call for each takes.
        values = json.loads(b"[" + b",".join(texts) + b"]")
        if len(values) == len(texts):
            return values
    values = []
    for text in texts:
        with suppress(ValueError, RecursionError):
            values.append(json.loads(text))
    return values


def _line(told: Any) -> bytes:
    text = json.dumps(told, allow_nan=False).encode()
    return f"{zlib.crc32(text):08x} ".encode() + text


def _is_whole(line: bytes) -> bool:
    return len(line) > 9 and line[:8] == f"{zlib.crc32(line[9:]):08x}".encode()
