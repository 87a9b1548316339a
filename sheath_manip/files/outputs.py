"""What a command writes: made aside, and given its name when it is whole.

Nothing half-made is left where it was asked for, whatever fails: what is there is there whole.
"""

import os
import shutil
import socket
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

PREFIX = ".tmp-"
"""of whatever is still being written"""


@contextmanager
def written_aside(final: Path, replacing: bool = True) -> Iterator[Path]:
    """Give a path to write a file or a folder to, which gets its `final` name on leaving.

    The path ends in the same name, and nothing is there yet. Where the block raises, or writes
    nothing, nothing is left and what was there before stays. What a killed process of this machine
    left beside it is swept away first. A file is on the disk before its name is; a folder is for
    its writer to sync.

    Args:
        final: the name, whose folder is made where there is none.
        replacing: whether it may take the name from another file; else FileExistsError is raised,
            also where another process was quicker.
    """
    final.parent.mkdir(parents=True, exist_ok=True)
    _sweep(final.parent)
    folder = final.parent / f"{PREFIX}{_host()}-{os.getpid()}-{uuid.uuid4().hex[:8]}"
    folder.mkdir()
    try:
        aside = folder / final.name
        yield aside
        if aside.is_file():
            sync(aside)
        if replacing:
            aside.replace(final)
        else:
            take_name(aside, final)
        sync(final.parent)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def sync(path: Path) -> None:
    """Return once the file or the directory's list of entries is on the disk; raises OSError."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def take_name(aside: Path, final: Path) -> None:
    """Rename without ever taking the name from another one; raises FileExistsError, and OSError.

    A file may keep its old name beside its new one.
    """
    if aside.is_dir():
        try:
            # A folder never replaces one that has entries, on any system.
            aside.rename(final)
        except OSError as error:
            if final.exists():
                raise FileExistsError(f"{final} exists") from error
            raise
        return
    try:
        # Unlike a rename, a link never takes the name from another file.
        final.hardlink_to(aside)
    except FileExistsError:
        raise
    except OSError:
        # A file system without links, such as that of a memory stick.
        if final.exists():
            raise FileExistsError(f"{final} exists") from None
        aside.rename(final)


def _sweep(folder: Path) -> None:
    """Delete what killed processes of this machine left."""
    for left in folder.glob(f"{PREFIX}{_host()}-*-*"):
        process = left.name.removeprefix(f"{PREFIX}{_host()}-").partition("-")[0]
        if process.isdigit() and not _runs(int(process)):
            shutil.rmtree(left, ignore_errors=True)


def _runs(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (PermissionError, OverflowError):
        pass
    return True


def _host() -> str:
    return "".join(letter for letter in socket.gethostname() if letter.isalnum())[:40]
