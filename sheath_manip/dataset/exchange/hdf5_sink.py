"""A file for HDF5 to write to, of which a full disk does not take the process with it.

Where a write fails, HDF5 cannot close the file, and dies with it (a segmentation fault when the
interpreter ends). So it is told that all was written, what has no place on the disk is kept in
memory until the file is closed, and the error is raised by `require_written`.
"""

import io
import os
from pathlib import Path
from typing import Any


class Hdf5Sink(io.RawIOBase):
    """A file object for `h5py.File`; it is asked for its error after each dataset."""

    def __init__(self, path: Path) -> None:
        """Begin an empty file."""
        super().__init__()
        self._file = path.open("x+b", buffering=0)
        self._error: OSError | None = None
        self._unwritten: dict[int, bytes] = {}
        self._at = 0

    def require_written(self) -> None:
        """Raise the OSError of the first write that failed."""
        if self._error is not None:
            raise self._error

    def readable(self) -> bool:
        """It is."""
        return True

    def writable(self) -> bool:
        """It is."""
        return True

    def seekable(self) -> bool:
        """It is."""
        return True

    def write(self, content: Any, /) -> int:
        """Write at the current place."""
        taken = bytes(content)
        if self._error is None:
            try:
                self._write_all(taken)
            except OSError as error:
                self._error = error
        if self._error is not None:
            self._unwritten[self._at] = taken
        self._at += len(taken)
        return len(taken)

    def readinto(self, into: Any, /) -> int:
        """Read from the current place, also what has no place on the disk."""
        view = memoryview(into).cast("B")
        size = len(view)
        found = bytearray(os.pread(self._file.fileno(), size, self._at).ljust(size, b"\0"))
        for start, content in self._unwritten.items():
            low, high = max(start, self._at), min(start + len(content), self._at + size)
            if low < high:
                found[low - self._at : high - self._at] = content[low - start : high - start]
        view[:] = found
        self._at += size
        return size

    def seek(self, to: int, whence: int = os.SEEK_SET, /) -> int:
        """Go to a place."""
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self._at, os.SEEK_END: self._size()}
        self._at = base[whence] + to
        return self._at

    def tell(self) -> int:
        """Return the current place."""
        return self._at

    def truncate(self, size: int | None = None, /) -> int:
        """Cut the file, or lengthen it."""
        size = self._at if size is None else size
        if self._error is None:
            try:
                self._file.truncate(size)
            except OSError as error:
                self._error = error
        return size

    def close(self) -> None:
        """Close the file."""
        self._file.close()
        super().close()

    def _size(self) -> int:
        ends = (start + len(content) for start, content in self._unwritten.items())
        return max(os.fstat(self._file.fileno()).st_size, *ends, 0)

    def _write_all(self, content: bytes) -> None:
        done = 0
        while done < len(content):
            done += os.pwrite(self._file.fileno(), content[done:], self._at + done)
