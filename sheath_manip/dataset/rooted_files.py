"""Files of a folder that others may have written: plain ones only, and none outside the folder.

A link may lead anywhere, and a reader of a fifo waits until somebody writes to it. Neither is
followed here nor waited for, whatever else may write into the folder meanwhile.
"""

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path, PurePosixPath

_FOLDER = os.O_DIRECTORY | os.O_RDONLY
# A fifo that nobody writes to would otherwise not even open.
_NOT_FOLLOWED = os.O_NOFOLLOW | os.O_NONBLOCK | os.O_RDONLY
_KINDS = {
    stat.S_IFLNK: "a link",
    stat.S_IFIFO: "a fifo",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


class OddFileError(OSError):
    """An entry that is neither a plain file nor a folder, or a file larger than may be."""


def read_inside(root: Path, file: str, most_bytes: int) -> bytes:
    """Return what is in `file`, a path with slashes below `root`.

    Raises FileNotFoundError, OddFileError where it is no plain file, lies behind a link or is
    larger than `most_bytes`, and OSError.
    """
    *folders, last = PurePosixPath(file).parts
    at = os.open(root, _FOLDER)
    try:
        for folder in folders:
            above, at = at, _open(folder, _FOLDER | os.O_NOFOLLOW, at, file)
            os.close(above)
        descriptor = _open(last, _NOT_FOLLOWED, at, file)
    finally:
        os.close(at)
    status = os.fstat(descriptor)
    if not stat.S_ISREG(status.st_mode):
        os.close(descriptor)
        raise OddFileError(f"{file} is {kind_of(status) or 'a folder'}, wanted a plain file")
    with os.fdopen(descriptor, "rb", buffering=0) as opened:
        # Asked again of what was read: it may grow, and a sparse one tells of what it has not.
        content = b"" if status.st_size > most_bytes else opened.read(most_bytes + 1) or b""
        while 0 < len(content) < status.st_size and (more := opened.read(status.st_size)):
            content += more
        if max(status.st_size, len(content)) > most_bytes:
            raise OddFileError(
                f"{file} has {max(status.st_size, len(content))} bytes, wanted at most {most_bytes}"
            )
    return content


def entries(folder: Path) -> Iterator[tuple[str, os.stat_result]]:
    """Yield each entry below `folder`, however deep, but nothing behind a link; raises OSError."""
    waiting = [""]
    while waiting:
        inside = waiting.pop()
        with os.scandir(folder / inside) as found:
            for entry in found:
                path = f"{inside}{entry.name}"
                status = entry.stat(follow_symlinks=False)
                if stat.S_ISDIR(status.st_mode):
                    waiting.append(f"{path}/")
                yield path, status


def entries_now(folder: Path) -> Iterator[tuple[Path, os.stat_result]]:
    """Yield what lies in `folder` itself, sorted by name; raises OSError.

    What another process takes away meanwhile, such as a file that gets its final name, is left out.
    """
    for path in sorted(folder.iterdir()):
        with suppress(FileNotFoundError):
            yield path, path.lstat()


def is_folder(path: Path) -> bool:
    """Return whether `path` itself is a folder, and no link to one."""
    try:
        return stat.S_ISDIR(path.lstat().st_mode)
    except OSError:
        return False


def kind_of(status: os.stat_result) -> str:
    """Return what an entry is, such as `a link`; empty for a plain file or a folder."""
    plain = stat.S_ISREG(status.st_mode) or stat.S_ISDIR(status.st_mode)
    return "" if plain else _KINDS.get(stat.S_IFMT(status.st_mode), "no file")


def _open(name: str, flags: int, at: int, file: str) -> int:
    try:
        return os.open(name, flags, dir_fd=at)
    except OSError as error:
        # As Linux and others say it of links, and of sockets.
        if error.errno in (errno.ELOOP, errno.EMLINK, errno.ENXIO, errno.ENOTDIR, errno.EOPNOTSUPP):
            raise OddFileError(f"{file} is or lies behind no plain file or folder") from error
        raise
