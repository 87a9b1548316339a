"""What reading another tool's file may take, in memory and in time: in proportion to its size."""

import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path

from sheath_manip.exceptions import StoreError

SLACK_BYTES = 256 << 20
MOST_TIMES_LARGER = 200
"""An episode may take `SLACK_BYTES` of memory, and so many times the bytes of the whole file on
top. Black images compress better than that, and are worth nothing."""
FILM_TIMES_LARGER = 2000
"""the same of a folder with films, where a still scene takes next to nothing: 10 s of two cameras
of 640 x 480 pixels were 670 times as large as their films"""
LEAST_S = 60.0
LEAST_BYTES_PER_S = 1e6
"""Reading a file may take `LEAST_S`, and the time that its bytes take at this rate on top."""
MOST_ENTRIES = 1_000_000
"""files of a folder, or members of an archive"""


def stored_bytes(path: Path) -> int:
    """Return the bytes of a file, or of all files in a folder; raises StoreError where it is none.

    Nothing is followed out of a folder.
    """
    if not path.exists():
        raise StoreError(f"wanted a file or a folder at {path}, found nothing")
    if not path.is_dir():
        return path.stat().st_size
    files = (Path(folder, name) for folder, _, names in os.walk(path) for name in names)
    return sum(file.lstat().st_size for file in islice(files, MOST_ENTRIES))


class Limits:
    """The limits of one file, or folder; the time runs while it is read."""

    def __init__(
        self, path: Path, stored_bytes: int, times_larger: int = MOST_TIMES_LARGER
    ) -> None:
        """Begin for what lies at `path`, has so many bytes and may be so many times larger."""
        self.path = path
        self.most_bytes = SLACK_BYTES + times_larger * stored_bytes
        # What unpacks to more takes as much longer.
        times = times_larger / MOST_TIMES_LARGER
        self.most_s = LEAST_S + times * stored_bytes / LEAST_BYTES_PER_S
        self._spent_s = 0.0
        self._since_s: float | None = None

    def begin(self) -> None:
        """Let the time run anew: the file is read once more."""
        self._spent_s = 0.0

    @contextmanager
    def reading(self) -> Iterator[None]:
        """Let the time run; what is done with what was read has all the time it takes."""
        self._since_s = time.monotonic()
        try:
            yield
        finally:
            self._spent_s += time.monotonic() - self._since_s
            self._since_s = None

    def require_memory(self, what: str, asked_bytes: int) -> None:
        """Raise StoreError where `what` would take more memory than it may."""
        self.require_time()
        if not 0 <= asked_bytes <= self.most_bytes:
            raise StoreError(
                f"{what} of {self.path} asks for {asked_bytes} bytes of memory; wanted at most "
                f"{self.most_bytes} for a file of its size"
            )

    def require_time(self) -> None:
        """Raise StoreError where reading has taken longer than it may."""
        now_s = time.monotonic()
        if self._spent_s + now_s - (self._since_s or now_s) > self.most_s:
            raise StoreError(
                f"reading {self.path} takes longer than {self.most_s:.0f} s, which is the most for "
                "a file of its size; split it"
            )
