"""Where the episodes of a store's directory lie: an archive each, or a folder as of before."""

import os
import stat
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

from sheath_manip.dataset.archive import SUFFIX, Archive, BrokenArchiveError, Signature
from sheath_manip.dataset.faults import REMEDY, FaultError, FaultKind
from sheath_manip.dataset.folder import Folder
from sheath_manip.dataset.marks import is_marks_name, marked_name
from sheath_manip.dataset.naming import episode_name, is_episode_name
from sheath_manip.dataset.rooted_files import OddFileError
from sheath_manip.exceptions import StoreError
from sheath_manip.types import EpisodeInfo

Place = Archive | Folder
Result = TypeVar("Result")
LONGEST_NAME = 255 - len(SUFFIX)
"""characters of an episode's name: file systems take 255 of a file's"""


def storable_name(info: EpisodeInfo) -> str:
    """Return the name of the episode of `info`; raises StoreError where no file can have it."""
    name = episode_name(info)
    if len(name) > LONGEST_NAME:
        raise StoreError(
            f"the method {info.method!r} makes a file name of {len(name)} characters, "
            f"wanted at most {LONGEST_NAME}; choose a shorter one in plain letters"
        )
    return name


def archive_path(store: Path, name: str) -> Path:
    """Return where the episode `name` is written."""
    return store / f"{name}{SUFFIX}"


def place_of(store: Path, name: str) -> Place | None:
    """Return where the episode `name` lies; None where there is none of that name."""
    if not is_episode_name(name):
        return None
    archive = archive_path(store, name)
    if os.path.lexists(archive):
        return Archive(archive)
    return Folder(store / name) if os.path.lexists(store / name) else None


def is_there(store: Path, name: str) -> bool:
    """Return whether anything has the name of an episode, also what is none."""
    return os.path.lexists(archive_path(store, name)) or os.path.lexists(store / name)


@dataclass(frozen=True)
class Listed:
    """The entries of a store's directory."""

    episodes: Mapping[str, Signature | None]
    """by name; None of a folder, whose files may change without it"""
    marked: frozenset[str]
    """the names of episodes that have marks, or had them"""

    @classmethod
    def of(cls, store: Path) -> "Listed":
        """Look into the directory; a link is no episode. Raises OSError."""
        episodes, marked = dict[str, Signature | None](), set[str]()
        with os.scandir(store) as entries:
            for entry in entries:
                name = entry.name.removesuffix(SUFFIX)
                if is_marks_name(entry.name):
                    marked.add(marked_name(entry.name))
                elif not is_episode_name(name):
                    continue
                elif name == entry.name:
                    if entry.is_dir(follow_symlinks=False):
                        episodes.setdefault(name, None)
                elif entry.is_file(follow_symlinks=False):
                    with suppress(FileNotFoundError):
                        episodes[name] = Signature.of(entry.stat(follow_symlinks=False))
        return cls(episodes, frozenset(marked))


def is_episode(file: str, status: os.stat_result) -> bool:
    """Return whether an entry of a store, a `file` or a folder, is an episode; a link is none."""
    name = file.removesuffix(SUFFIX)
    wanted = stat.S_ISDIR if name == file else stat.S_ISREG
    return is_episode_name(name) and wanted(status.st_mode)


def faults_told(name: str, file: str, read: Callable[[], Result]) -> Result:
    """Return what `read` gives of a `file` of the episode `name`, or of it as a whole.

    Raises FaultError where that cannot be read.
    """
    try:
        return read()
    except FileNotFoundError as error:
        raise FaultError(name, FaultKind.MISSING, f"{file or 'it'} is missing; {REMEDY}") from error
    except OddFileError as error:
        raise FaultError(name, FaultKind.ODD_FILE, f"{error}; {REMEDY}") from error
    except (BrokenArchiveError, OSError) as error:
        reason = f"{file or 'it'} cannot be read ({error}); {REMEDY}"
        raise FaultError(name, FaultKind.UNREADABLE, reason) from error


def name_is_taken(store: Path, name: str) -> StoreError:
    """Return what is raised where another episode has the name."""
    return StoreError(
        f"{store} already holds {name}, and it is kept; skip what `EpisodeStore.has` knows, or "
        "record under another run seed or into a new store"
    )
