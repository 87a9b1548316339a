"""An episode's group as one zip file, in which nothing is compressed twice: zarr's `ZipStore`.

It is written once, beside its place, and never changed: so the list of what is in it, which a zip
file has at its end, is there whole or the file has no name yet.
Format: https://pkware.cachefly.net/webdocs/casestudies/APPNOTE.TXT (4.3)
"""

import os
import stat
import struct
import zipfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from sheath_manip.dataset.rooted_files import OddFileError, kind_of
from sheath_manip.dataset.zarr_files import File
from sheath_manip.files.outputs import sync, take_name

SUFFIX = ".zarr.zip"
"""of the name of an episode's file"""
_MOST_LIST_BYTES = 256 << 20
"""of the list at the end: over a million files"""
_END, _LARGE_END = struct.Struct("<4s4H2LH"), struct.Struct("<4sQ2H2L4Q4sLQL")
"""the last bytes of a file without a comment, and those before them where it is large"""
_LOCAL = struct.Struct("<4s5H3L2H")
"""what is before each file"""
_LARGE = 0xFFFFFFFF
_UTF8 = 0x800
"""the flag of names that are not ASCII"""
_FILE_MODE = (stat.S_IFREG | 0o644) << 16
_UNDATED = (1980, 1, 1, 0, 0, 0)
"""The same content is the same file."""


@dataclass(frozen=True)
class Signature:
    """What changes whenever a file does: no program can set when it was last changed."""

    inode: int
    bytes: int
    changed_ns: int

    @classmethod
    def of(cls, status: os.stat_result) -> "Signature":
        """Return that of a file."""
        return cls(status.st_ino, status.st_size, status.st_ctime_ns)


@dataclass(frozen=True)
class _Place:
    """Where a file lies in an archive."""

    header: int
    """where what is before it begins"""
    bytes: int


class BrokenArchiveError(ValueError):
    """A file that is no archive as `write_archive` writes them."""


def write_archive(files: Iterable[File], path: Path) -> None:
    """Write a new archive, each file as it comes; all of it is on the disk on return."""
    with path.open("xb") as opened:
        with zipfile.ZipFile(opened, "w", zipfile.ZIP_STORED) as archive:
            for name, content in files:
                entry = zipfile.ZipInfo(name, _UNDATED)
                entry.external_attr, entry.create_system = _FILE_MODE, 3
                archive.writestr(entry, content)
        opened.flush()
        os.fsync(opened.fileno())


def give_name(archive: Path, final: Path) -> None:
    """Give an archive, which is on the disk, its `final` name on the same file system.

    The name is on the disk on return. Raises FileExistsError where it is taken: of two that race
    for it, one gets it.
    """
    take_name(archive, final)
    archive.unlink(missing_ok=True)
    sync(final.parent)


class Archive:
    """The files in an archive; every call opens it anew, so that it may be dropped meanwhile."""

    def __init__(self, path: Path) -> None:
        self.path = path
        # It is read a file at a time, and its list is the same each time.
        self._known: tuple[Signature, Mapping[str, _Place]] | None = None

    def files(self) -> Mapping[str, int]:
        """The size in bytes of each file in it, by its path.

        Raises OddFileError where it is no plain file, BrokenArchiveError and OSError.
        """
        with _opened(self.path) as descriptor:
            return {name: place.bytes for name, place in self._places(descriptor).items()}

    def content(self, file: str, most_bytes: int) -> bytes:
        """Return what is in a file.

        Raises FileNotFoundError where there is none, and OddFileError where it has more bytes;
        else as `files`.
        """
        with self.opened() as content:
            return content(file, most_bytes)

    @contextmanager
    def opened(self) -> Iterator[Callable[[str, int], bytes]]:
        """Give what returns `content` while it is open, for many files; raises as `files`."""
        with _opened(self.path) as descriptor:
            places = self._places(descriptor)

            def content(file: str, most_bytes: int) -> bytes:
                place = places.get(file)
                if place is None:
                    raise FileNotFoundError(file)
                if place.bytes > most_bytes:
                    raise OddFileError(
                        f"{file} has {place.bytes} bytes, wanted at most {most_bytes}"
                    )
                return _content(descriptor, file, place)

            yield content

    def require_intact(self) -> None:
        """Raise BrokenArchiveError where another program's reader of zip files would stop."""
        try:
            with zipfile.ZipFile(self.path) as archive:
                wrong = archive.testzip()
        except (zipfile.BadZipFile, OSError, ValueError, RuntimeError, struct.error) as error:
            raise BrokenArchiveError(str(error)) from error
        if wrong is not None:
            raise BrokenArchiveError(f"{wrong} has another checksum")

    def _places(self, descriptor: int) -> Mapping[str, _Place]:
        at = Signature.of(os.fstat(descriptor))
        if self._known is None or self._known[0] != at:
            self._known = at, _places(descriptor, at.bytes)
        return self._known[1]


@contextmanager
def _opened(path: Path) -> Iterator[int]:
    """Open a plain file, which is neither followed nor waited for where it is another."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    except FileNotFoundError:
        raise
    except OSError as error:
        kind = kind_of(path.lstat())
        raise OddFileError(f"{path.name} is {kind}") if kind else error from error
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            kind = kind_of(status) or "a folder"
            raise OddFileError(f"{path.name} is {kind}, wanted a plain file")
        yield descriptor
    finally:
        os.close(descriptor)


def _places(descriptor: int, bytes: int) -> Mapping[str, _Place]:
    """Read the list at the end; raises BrokenArchiveError for all that is not written here."""
    _require_list(descriptor, bytes)
    try:
        with os.fdopen(os.dup(descriptor), "rb") as opened, zipfile.ZipFile(opened) as archive:
            entries = archive.infolist()
    # Of hostile files zipfile raises all of these.
    except (zipfile.BadZipFile, NotImplementedError, ValueError, struct.error, OSError) as error:
        raise BrokenArchiveError(str(error)) from error
    places = dict[str, _Place]()
    for entry in entries:
        name, inside = entry.filename, PurePosixPath(entry.filename)
        plain = str(inside) == name and not inside.is_absolute() and ".." not in inside.parts
        if not plain or "\\" in name or name in places:
            raise BrokenArchiveError(f"{name!r:.80} is no name for a file in it")
        if (
            entry.compress_type != zipfile.ZIP_STORED
            or entry.flag_bits & ~_UTF8
            or entry.file_size != entry.compress_size
            or not 0 <= entry.header_offset <= bytes - entry.file_size
        ):
            raise BrokenArchiveError(f"{name!r:.80} is not stored as is usual here")
        places[name] = _Place(entry.header_offset, entry.file_size)
    return places


def _require_list(descriptor: int, bytes: int) -> None:
    """Raise BrokenArchiveError where no list of a size that may be ends the file."""
    end = os.pread(descriptor, _END.size, max(0, bytes - _END.size))
    if len(end) != _END.size or not end.startswith(b"PK\5\6") or end[-2:] != b"\0\0":
        raise BrokenArchiveError("it has no list of its files at its end: it was cut off")
    list_bytes = _END.unpack(end)[5]
    before = os.pread(descriptor, _LARGE_END.size, max(0, bytes - _END.size - _LARGE_END.size))
    if len(before) == _LARGE_END.size and before.startswith(b"PK\6\6"):
        list_bytes = max(_LARGE_END.unpack(before)[8], 0 if list_bytes == _LARGE else list_bytes)
    if list_bytes > min(_MOST_LIST_BYTES, bytes):
        raise BrokenArchiveError(f"the list of its files takes {list_bytes} bytes")


def _content(descriptor: int, file: str, place: _Place) -> bytes:
    before = os.pread(descriptor, _LOCAL.size, place.header)
    if len(before) != _LOCAL.size or not before.startswith(b"PK\3\4"):
        raise BrokenArchiveError(f"{file} is not where the list of files says")
    *_, name_bytes, extra_bytes = _LOCAL.unpack(before)
    start, parts, left = place.header + _LOCAL.size + name_bytes + extra_bytes, [], place.bytes
    while left:
        # A system reads 2 GB at most at a time.
        part = os.pread(descriptor, left, start)
        if not part:
            raise BrokenArchiveError(f"{file} is cut off")
        parts.append(part)
        start, left = start + len(part), left - len(part)
    return parts[0] if len(parts) == 1 else b"".join(parts)
