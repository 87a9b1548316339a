"""Making files and directories survive a crash, and appear all at once or not at all."""

import os
from pathlib import Path


def sync(path: Path) -> None:
    """Return once the file or the directory's list of entries is on the disk; raises OSError."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def publish(directory: Path, final: Path) -> None:
    """Give a finished `directory` its `final` name on the same file system.

    Everything in it is on the disk before the new name is, and the new name is on return. Raises
    FileExistsError where that name is taken: of two that race for it, one gets it whole.
    """
    for folder, _, files in os.walk(directory, topdown=False):
        for file in files:
            sync(Path(folder, file))
        sync(Path(folder))
    try:
        # A directory never replaces one that has entries, on any system.
        directory.rename(final)
    except OSError as error:
        if final.exists():
            raise FileExistsError(f"{final} exists") from error
        raise
    sync(final.parent)


def publish_file(file: Path, final: Path) -> None:
    """Give a finished `file` its `final` name on the same file system, as `publish` does."""
    sync(file)
    # Unlike a rename, a link never takes the name from another file.
    final.hardlink_to(file)
    file.unlink()
    sync(final.parent)
