"""The episode store: a directory with one immutable zarr group an episode, each in one file.

An episode is written aside, synced, and renamed to its name: any number of processes may append and
read at once without a lock, and a crash leaves nothing but a `.tmp-*` that no reader looks at.
"""

import os
import shutil
import uuid
from collections.abc import Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import fields, replace
from functools import partial
from pathlib import Path

from sheath_manip.dataset.archive import Archive, Signature, give_name, write_archive
from sheath_manip.dataset.attributes import GROUP_FILE, MOST_BYTES, parse_header
from sheath_manip.dataset.beside import faults_beside_episodes
from sheath_manip.dataset.content import is_same
from sheath_manip.dataset.disk import require_room, with_room
from sheath_manip.dataset.durable import sync
from sheath_manip.dataset.faults import Fault, FaultError, FaultKind
from sheath_manip.dataset.glance import EpisodeSummary
from sheath_manip.dataset.group import Content
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.index import EpisodeIndex
from sheath_manip.dataset.listing import indexed_summaries
from sheath_manip.dataset.marker import bring_up_marker, require_marker, write_marker
from sheath_manip.dataset.marks import Marks, marks_faults, marks_path, read_marks, write_marks
from sheath_manip.dataset.naming import LEFTOVER_PREFIX
from sheath_manip.dataset.places import (
    Listed,
    Place,
    archive_path,
    faults_told,
    is_there,
    name_is_taken,
    place_of,
    storable_name,
)
from sheath_manip.dataset.reader import LARGEST_FILE_BYTES, EpisodeReader, no_such_episode
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.rooted_files import is_folder
from sheath_manip.dataset.space import Space
from sheath_manip.dataset.steps import recorded_of
from sheath_manip.dataset.storable import storable_files
from sheath_manip.dataset.zarr_files import File
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Episode, EpisodeInfo


class EpisodeStore(EpisodeReader):
    """The episodes of one directory; `EpisodeStore.create` also makes the directory.

    Raises StoreError where `path` is no store.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        require_marker(self.path)
        self._index = EpisodeIndex(self.path)
        self._last: tuple[str, Place] | None = None
        """what was looked for last: an episode is read a file at a time"""

    @property
    def address(self) -> str:
        """The directory, as it was given."""
        return str(self.path)

    @property
    def folder(self) -> Path:
        """The directory."""
        return self.path

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
        name = storable_name(recorded.header.info)
        if is_there(self.path, name):
            raise name_is_taken(self.path, name)
        self._publish(name, storable_files(recorded))
        return name

    def keep(self, recorded: Recorded) -> str:
        """Write an episode as `append_arrays`, or find that the very same is there; give its name.

        So two processes may record the same run into one store: whichever is first stores it.
        """
        name = storable_name(recorded.header.info)
        self._publish(name, storable_files(recorded), may_be_there=True)
        return name

    def copy_from(self, source: EpisodeReader, name: str) -> None:
        """Write the episode `name` of `source` here, each file of its group byte for byte.

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
        if name not in self.names():
            raise no_such_episode(self.address, name)
        aside, path = self._aside(), self._place(name).path
        try:
            # At once out of every reader's sight; a crash leaves it to `sheath data repair`.
            path.rename(aside)
            marks_path(self.path, name).unlink(missing_ok=True)
            sync(self.path)
            shutil.rmtree(aside) if is_folder(aside) else aside.unlink()
        except OSError as error:
            raise StoreError(f"cannot drop {name} of {self.path} ({error})") from error

    def _publish(self, name: str, files: Iterable[File], may_be_there: bool = False) -> None:
        """Write `files` into an archive aside, then give it its name.

        Where the very same `may_be_there` under that name and is, all is well.
        """
        aside = self._aside()
        try:
            bring_up_marker(self.path)
            write_archive(with_room(self.path, files), aside)
            if os.path.lexists(self.path / name):
                raise FileExistsError(f"{name} is there as a folder")
            give_name(aside, archive_path(self.path, name))
            self._noted(name)
        except FileExistsError as error:
            written = Archive(aside).content(GROUP_FILE, MOST_BYTES)
            if not may_be_there or not is_same(self.header(name), parse_header(name, written)):
                raise name_is_taken(self.path, name) from error
        except OSError as error:
            raise StoreError(f"cannot write {name} into {self.path} ({error})") from error
        finally:
            # After a success there is nothing left of that name.
            aside.unlink(missing_ok=True)

    def _aside(self) -> Path:
        return self.path / f"{LEFTOVER_PREFIX}{uuid.uuid4().hex}"

    def has(self, info: EpisodeInfo) -> bool:
        """Return whether the episode of `info` is stored, so that a resumed run may skip it.

        Raises StoreError where its name is taken by an episode of another task, variant, checkpoint
        or control rate: skipping that one would mix two runs.
        """
        name = storable_name(info)
        if not is_there(self.path, name):
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

    def summaries(self) -> Iterator[EpisodeSummary | StoreError]:
        """Yield each episode at a glance, sorted by name, or what is wrong with its header.

        An episode of which the index tells is not opened.
        """
        return indexed_summaries(self, self._index, self._listed())

    def _noted(self, name: str) -> None:
        """Note an episode that was written; whatever is wrong with it is found by its readers."""
        with suppress(StoreError, OSError):
            at = Signature.of(archive_path(self.path, name).lstat())
            self._index.note(at, self.unmarked_summary(name))

    def _listed(self) -> Listed:
        try:
            return Listed.of(self.path)
        except OSError as error:
            raise StoreError(f"cannot list {self.path} ({error})") from error

    def names(self) -> list[str]:
        """The names of all episodes, sorted; entries that are no episode are left out."""
        return sorted(self._listed().episodes)

    def header(self, name: str) -> Header:
        """Return all of the episode `name` that is no array.

        Raises StoreError where it is damaged.
        """
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
        return faults_told(name, "", self._place(name).files)

    def odd_files(self, name: str) -> Mapping[str, str]:
        """What is neither file nor folder in an episode's folder, by its path: such as `a link`.

        An archive has nothing of the kind.
        """
        place = self._place(name)
        return {} if isinstance(place, Archive) else faults_told(name, "", place.odd_files)

    def content(self, name: str, file: str, most_bytes: int = LARGEST_FILE_BYTES) -> bytes:
        """Return what is in one of the `files` of an episode; raises FaultError."""
        return faults_told(name, file, lambda: self._place(name).content(file, most_bytes))

    @contextmanager
    def opened(self, name: str) -> Iterator[Content]:
        """Give what returns `content` of the episode's files, where many of them are read."""
        place = self._place(name)
        if not isinstance(place, Archive):
            yield partial(self.content, name)
            return
        with ExitStack() as stack:
            read = faults_told(name, "", lambda: stack.enter_context(place.opened()))
            yield lambda file, most_bytes: faults_told(name, file, lambda: read(file, most_bytes))

    def require_intact(self, name: str) -> None:
        """Raise FaultError where other programs could not open the episode's file."""
        faults_told(name, "", self._place(name).require_intact)

    def _place(self, name: str) -> Place:
        """Where the episode lies; raises StoreError where there is none."""
        # Taken once: another thread may be reading another episode.
        last = self._last
        if last is None or last[0] != name or not os.path.lexists(last[1].path):
            place = place_of(self.path, name)
            if place is None:
                raise no_such_episode(self.address, name)
            last = self._last = name, place
        return last[1]

    def entry_faults(self) -> list[Fault]:
        """The leftovers, and what does not belong into the directory."""
        return [*faults_beside_episodes(self.path), *marks_faults(self.path, set(self.names()))]
