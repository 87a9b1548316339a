"""Making files and directories survive a crash, and appear all at once or not at all."""

import ctypes
import os
from pathlib import Path

from sheath_manip.files.outputs import sync

# Linux has it and os has not; it tells of failed writes as fsync does.
_syncfs = getattr(ctypes.CDLL(None, use_errno=True), "syncfs", None)


def sync_tree(directory: Path) -> None:
    """Return once everything in `directory` is on the disk; raises OSError.

    Where it can, by one call for the whole file system: to wait for each of many files costs ten
    times as much as all that it takes to write them.
    """
    if _syncfs is None:
        for folder, _, files in os.walk(directory, topdown=False):
            for file in files:
                sync(Path(folder, file))
            sync(Path(folder))
        return
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        if _syncfs(descriptor):
            code = ctypes.get_errno()
            raise OSError(code, os.strerror(code), str(directory))
    finally:
        os.close(descriptor)


def publish(directory: Path, final: Path) -> None:
    """Give a finished `directory` its `final` name on the same file system.

    Everything in it is on the disk before the new name is, and the new name is on return. Raises
    FileExistsError where that name is taken: of two that race for it, one gets it whole.
    """
    sync_tree(directory)
    try:
        # A directory never replaces one that has entries, on any system.
        directory.rename(final)
    except OSError as error:
        if final.exists():
            raise FileExistsError(f"{final} exists") from error
        raise
    sync(final.parent)
