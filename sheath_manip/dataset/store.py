"""The episode store: a directory with one immutable zarr group an episode.

An episode is written aside, synced, and renamed to its name: any number of processes may append and
read at once without a lock, and a crash leaves nothing but a `.tmp-*` that no reader looks at.
"""

import os
import shutil
import stat
import uuid
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from pathlib import Path

from sheath_manip.dataset.attributes import GROUP_FILE, MOST_BYTES, parse_header, require_storable
from sheath_manip.dataset.beside import faults_beside_episodes
from sheath_manip.dataset.content import is_same
from sheath_manip.dataset.disk import require_room, with_room
from sheath_manip.dataset.durable import publish_files, sync
from sheath_manip.dataset.faults import REMEDY, Fault, FaultError, FaultKind
from sheath_manip.dataset.group import episode_files
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.marker import require_marker, write_marker
from sheath_manip.dataset.marks import (
    Marks,
    marks_faults,
    marks_path,
    read_marks,
    write_marks,
)
from sheath_manip.dataset.naming import LEFTOVER_PREFIX, episode_name, is_episode_name
from sheath_manip.dataset.reader import LARGEST_FILE_BYTES, EpisodeReader, no_such_episode
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.rooted_files import (
    OddFileError,
    entries,
    is_folder,
    kind_of,
    read_inside,
)
from sheath_manip.dataset.space import Space
from sheath_manip.dataset.steps import not_finite, recorded_of, require_layout, require_sound
from sheath_manip.dataset.zarr_files import File
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Episode, EpisodeInfo

LONGEST_NAME = 255
"""characters in the name of a directory, on the usual file systems"""


class EpisodeStore(EpisodeReader):
    """The episodes of one directory; `EpisodeStore.create` also makes the directory.

    Raises StoreError where `path` is no store.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        require_marker(self.path)

    @property
    def address(self) -> str:
        """The directory, as it was given."""
        return str(self.path)

    @classmethod
    def create(cls, path: str | Path) -> "EpisodeStore":
        """Open the store at `path`, made first where nothing or an empty directory is there.

        Raises StoreError where something else is.
        """
        path = Path(path)
        try:
            write_marker(path)
        except OSError as error:
            raise StoreError(
                f"cannot make an episode store at {path} ({error}); choose a writable directory"
            ) from error
        return cls(path)

    def append(self, episode: Episode, space: Space | None = None) -> str:
        """Write `episode`, synced to the disk on return, and give its name.

        `space` says what its features and actions mean. Raises StoreError, with nothing changed,
        where an episode of that name exists (ask `has` first), where an executed or labelled action
        is not finite, where the steps' arrays disagree in shape or have other types than `types`
        declares, and where the disk is nearly full.
        """
        return self.append_arrays(recorded_of(episode, space))

    def append_arrays(self, recorded: Recorded) -> str:
        """Write an episode as it was recorded, with its own date and versions; give its name.

        Raises StoreError as `append` does.
        """
        name = self._directory(recorded.header.info).name
        if os.path.lexists(self.path / name):
            raise _taken(self.path, name)
        self._publish(name, self._files(recorded))
        return name

    def keep(self, recorded: Recorded) -> str:
        """Write an episode as `append_arrays`, or find that the very same is there; give its name.

        So two processes may record the same run into one store: whichever is first stores it.
        """
        name = self._directory(recorded.header.info).name
        self._publish(name, self._files(recorded), may_be_there=True)
        return name

    def _files(self, recorded: Recorded) -> Iterable[File]:
        """The files of an episode, made as they are asked for; StoreError where it is none."""
        header, arrays = recorded.header, recorded.arrays
        require_storable(header)
        require_layout(header, arrays)
        for array in not_finite(arrays):
            raise StoreError(
                f"{episode_name(header.info)}: an action in {array!r} is not finite; "
                "check actions with ActionSpec.validated"
            )
        require_sound(header, arrays)
        return episode_files(recorded)

    def copy_from(self, source: EpisodeReader, name: str) -> None:
        """Write the episode `name` of `source` here, byte for byte.

        Raises StoreError as `append` does, and where `source` cannot give it.
        """
        files = source.files(name)
        require_room(self.path, sum(files.values()))
        self._publish(name, ((file, source.content(name, file)) for file in files))
        self.mark(name, source.marks(name))

    def marks(self, name: str) -> Marks:
        """Return what a person said of the episode afterwards.

        Raises StoreError where that is broken.
        """
        return read_marks(self.path, name)

    def mark(self, name: str, marks: Marks) -> None:
        """Keep what a person says of the episode, beside it; raises StoreError."""
        length = self.header(name).length
        if marks.bad and marks.bad[-1][1] > length:
            raise StoreError(
                f"{name} has {length} steps; wanted bad stretches within them, got "
                f"{marks.bad[-1][0]} .. {marks.bad[-1][1]}"
            )
        try:
            write_marks(self.path, name, marks)
        except OSError as error:
            raise StoreError(f"cannot mark {name} of {self.path} ({error})") from error

    def drop(self, name: str) -> None:
        """Delete the episode for good, damaged or not; raises StoreError where there is none."""
        if not is_episode_name(name) or not is_folder(self.path / name):
            raise no_such_episode(self.address, name)
        aside = self._aside()
        try:
            # At once out of every reader's sight; a crash leaves it to `sheath data repair`.
            (self.path / name).rename(aside)
            marks_path(self.path, name).unlink(missing_ok=True)
            sync(self.path)
            shutil.rmtree(aside)
        except OSError as error:
            raise StoreError(f"cannot drop {name} of {self.path} ({error})") from error

    def _publish(self, name: str, files: Iterable[File], may_be_there: bool = False) -> None:
        """Write `files` into a directory aside, then give it its name.

        Where the very same `may_be_there` under that name and is, all is well.
        """
        aside = self._aside()
        try:
            publish_files(with_room(self.path, files), aside, self.path / name)
        except FileExistsError as error:
            written = read_inside(aside, GROUP_FILE, MOST_BYTES)
            if not may_be_there or not is_same(self.header(name), parse_header(name, written)):
                raise _taken(self.path, name) from error
        except OSError as error:
            raise StoreError(f"cannot write {name} into {self.path} ({error})") from error
        finally:
            # After a success there is nothing left of that name.
            shutil.rmtree(aside, ignore_errors=True)

    def _aside(self) -> Path:
        return self.path / f"{LEFTOVER_PREFIX}{uuid.uuid4().hex}"

    def has(self, info: EpisodeInfo) -> bool:
        """Return whether the episode of `info` is stored, so that a resumed run may skip it.

        Raises StoreError where its name is taken by an episode of another task, variant, checkpoint
        or control rate: skipping that one would mix two runs.
        """
        name = self._directory(info).name
        if not os.path.lexists(self.path / name):
            return False
        held = self.header(name).info
        if not held.variant:
            # Of before episodes said theirs: only its name can be gone by, as then.
            held = replace(held, variant=info.variant)
        if held != info:
            both = ((f.name, getattr(held, f.name), getattr(info, f.name)) for f in fields(info))
            differing = ", ".join(f"{key} {a!r} instead of {b!r}" for key, a, b in both if a != b)
            raise StoreError(
                f"{self.path} holds {name} of another run: {differing}; record into a new store"
            )
        return True

    def names(self) -> list[str]:
        """The names of all episodes, sorted; entries that are no episode are left out."""
        try:
            with os.scandir(self.path) as entries:
                found = [
                    entry.name
                    for entry in entries
                    if is_episode_name(entry.name) and entry.is_dir(follow_symlinks=False)
                ]
        except OSError as error:
            raise StoreError(f"cannot list {self.path} ({error})") from error
        return sorted(found)

    def header(self, name: str) -> Header:
        """Return all of the episode `name` that is no array.

        Raises StoreError where it is damaged.
        """
        if not is_episode_name(name) or not os.path.lexists(self.path / name):
            raise no_such_episode(self.address, name)
        try:
            content = self.content(name, GROUP_FILE, MOST_BYTES)
        except FaultError as error:
            if error.fault.kind is not FaultKind.MISSING:
                raise
            raise FaultError(
                name,
                FaultKind.FOREIGN,
                "wanted an episode, found no zarr.json in it; see `sheath data list`",
            ) from error
        return parse_header(name, content)

    def files(self, name: str) -> Mapping[str, int]:
        """The size in bytes of each file of the episode, by its path in the episode's folder."""
        found = self._entries(name)
        return {path: at.st_size for path, at in found if stat.S_ISREG(at.st_mode)}

    def odd_files(self, name: str) -> Mapping[str, str]:
        """What is neither file nor folder in an episode's folder, by its path: such as `a link`."""
        return {path: kind for path, at in self._entries(name) if (kind := kind_of(at))}

    def _entries(self, name: str) -> list[tuple[str, os.stat_result]]:
        try:
            return sorted(entries(self.path / name))
        except OSError as error:
            raise StoreError(f"cannot list {name} in {self.path} ({error})") from error

    def content(self, name: str, file: str, most_bytes: int = LARGEST_FILE_BYTES) -> bytes:
        """Return what is in one of the `files` of an episode; raises FaultError."""
        try:
            return read_inside(self.path, f"{name}/{file}", most_bytes)
        except FileNotFoundError as error:
            raise FaultError(name, FaultKind.MISSING, f"{file} is missing; {REMEDY}") from error
        except OddFileError as error:
            raise FaultError(name, FaultKind.ODD_FILE, f"{error}; {REMEDY}") from error
        except OSError as error:
            reason = f"{file} cannot be read ({error}); {REMEDY}"
            raise FaultError(name, FaultKind.UNREADABLE, reason) from error

    def entry_faults(self) -> list[Fault]:
        """The leftovers, and what does not belong into the directory."""
        return [*faults_beside_episodes(self.path), *marks_faults(self.path, set(self.names()))]

    def _directory(self, info: EpisodeInfo) -> Path:
        name = episode_name(info)
        if len(name) > LONGEST_NAME:
            raise StoreError(
                f"the method {info.method!r} makes a directory name of {len(name)} characters, "
                f"wanted at most {LONGEST_NAME}; choose a shorter one in plain letters"
            )
        return self.path / name


def _taken(path: Path, name: str) -> StoreError:
    return StoreError(
        f"{path} already holds {name}, and it is kept; skip what `EpisodeStore.has` knows, or "
        "record under another run seed or into a new store"
    )
