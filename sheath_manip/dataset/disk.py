"""Room on the disk, asked for before anything is written."""

import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path

from sheath_manip.dataset.zarr_files import File
from sheath_manip.exceptions import StoreError

FREE_BYTES_KEPT = 200_000_000
"""A disk filled to the brim takes more down with it than one recording."""
_ASKED_AFTER_BYTES = 16 << 20


def with_room(path: Path, files: Iterable[File]) -> Iterator[File]:
    """Yield the files that are to be written to the disk of `path`, one after the other.

    Raises StoreError before one that would leave less free than is kept.
    """
    room = 0
    for file in files:
        size = len(file[1])
        if size > room:
            require_room(path, size)
            room = max(size, _ASKED_AFTER_BYTES)
        room -= size
        yield file


def require_room(path: Path, needed_bytes: int) -> None:
    """Raise StoreError where the disk of `path` has not that much beside what is kept free."""
    free_bytes = shutil.disk_usage(path).free
    if free_bytes < FREE_BYTES_KEPT + needed_bytes:
        raise StoreError(
            f"the disk of {path} has {free_bytes / 1e6:.0f} MB free, wanted "
            f"{(FREE_BYTES_KEPT + needed_bytes) / 1e6:.0f} MB; free some or record elsewhere "
            "(what was recorded before is safe)"
        )
