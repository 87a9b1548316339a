"""Opening a file that somebody else made: a plain one or none at all."""

import hashlib
import io
import os
import stat
from pathlib import Path


def open_plain(path: Path, follow: bool = True) -> io.BufferedReader:
    """Open a regular file to read its bytes.

    A pipe, a socket or a device raises OSError at once, and never holds up who asks. A link is
    followed where `follow` says so; links in the folders above it are always.
    """
    # Without waiting: to open a pipe would last until somebody writes into it.
    flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
    if not follow:
        flags |= getattr(os, "O_NOFOLLOW", 0)
        if path.is_symlink():
            raise OSError(f"{path} is a link, wanted a plain file")
    descriptor = os.open(path, flags)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(f"{path} is no plain file")
    return os.fdopen(descriptor, "rb")


def read_plain(path: Path, most_bytes: int, follow: bool = True) -> bytes:
    """Return what a regular file holds; raises OSError as `open_plain`, and for a larger one."""
    with open_plain(path, follow) as file:
        size = os.fstat(file.fileno()).st_size
        if size > most_bytes:
            raise OSError(f"{path} has {size} bytes, wanted at most {most_bytes}")
        return file.read(most_bytes)


def sha256_of(path: Path) -> str:
    """Return the 64 hex digits of a file's content; raises OSError as `open_plain`."""
    with open_plain(path) as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
