"""Reading episodes, wherever they are kept."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, nullcontext, suppress
from functools import partial
from pathlib import Path

from numpy.typing import NDArray

from sheath_manip.dataset.compatibility import RecordedSpec, require_compatible
from sheath_manip.dataset.faults import Fault, FaultError
from sheath_manip.dataset.glance import EpisodeSummary
from sheath_manip.dataset.group import Content, blocks, read_array, require_memory
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import MOST_CHUNK_BYTES, ArraySpec, layout
from sheath_manip.dataset.marks import Marks, learnable
from sheath_manip.dataset.moments import COLUMNS, EpisodeMoments
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.rows import episode_from
from sheath_manip.dataset.steps import require_sound
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Episode, Outcome, Purpose

LARGEST_FILE_BYTES = 2 * MOST_CHUNK_BYTES
"""No file of an episode is that large."""


class EpisodeReader(ABC):
    """The committed episodes of one place."""

    @property
    @abstractmethod
    def address(self) -> str:
        """The address of the store: a directory or a URL."""

    @property
    def folder(self) -> Path | None:
        """The directory of this machine that the episodes lie in; None where they lie elsewhere."""
        return None

    @abstractmethod
    def names(self) -> list[str]:
        """The names of all episodes, sorted."""

    @abstractmethod
    def header(self, name: str) -> Header:
        """Return all of the episode `name` that is no array.

        Raises StoreError where it is damaged.
        """

    def array(self, name: str, spec: ArraySpec, thorough: bool = False) -> NDArray:
        """The array `spec` of the episode `name`; raises StoreError where it is damaged.

        If `thorough`, it is also held against the digest of all its values.
        """
        with self.opened(name) as content:
            return read_array(name, spec, content, thorough)

    def require_whole(self, name: str, spec: ArraySpec) -> None:
        """Raise StoreError where an array is damaged; holds one block of it at a time."""
        with self.opened(name) as content:
            for _ in blocks(name, spec, content):
                pass

    @abstractmethod
    def files(self, name: str) -> Mapping[str, int]:
        """The size in bytes of each file of the episode, by its path in the episode's folder."""

    @abstractmethod
    def content(self, name: str, file: str, most_bytes: int = LARGEST_FILE_BYTES) -> bytes:
        """Return what is in one of the `files` of an episode.

        Raises StoreError, and FaultError where it is damaged, missing or of more bytes.
        """

    def opened(self, name: str) -> AbstractContextManager[Content]:
        """Give what returns `content` of the episode's files, where many of them are read."""
        return nullcontext(partial(self.content, name))

    def odd_files(self, name: str) -> Mapping[str, str]:  # noqa: ARG002
        """What is neither file nor folder in an episode's folder, by its path: such as `a link`.

        Places that are no directory have nothing of the kind.
        """
        return {}

    def require_intact(self, name: str) -> None:  # noqa: B027
        """Raise FaultError where other programs could not open what holds the episode's files.

        Places where each file lies by itself have nothing of the kind.
        """

    @abstractmethod
    def entry_faults(self) -> list[Fault]:
        """Return what is wrong with other entries of the store."""

    def require_fits(self, spec: RecordedSpec, who: str) -> None:
        """Raise StoreError where `who`, of `spec`, is not to be put beside what is here.

        Held against the first episode that can be read: what is here fits each other.
        """
        held = self.example()
        if held is not None:
            whose, wanted = held
            require_compatible(wanted, spec, who, whose, "give a store of its own")

    def example(self) -> tuple[str, RecordedSpec] | None:
        """Return what the first episode that can be read is called, and its spec."""
        for name in self.names():
            with suppress(FaultError):
                return f"{name} of {self.address}", RecordedSpec.of(self.header(name))
        return None

    def marks(self, name: str) -> Marks:  # noqa: ARG002
        """Return what a person said of the episode afterwards.

        Raises StoreError where that is broken.

        Places that keep no marks have none.
        """
        return Marks()

    def mark(self, name: str, marks: Marks) -> None:  # noqa: ARG002
        """Keep what a person says of the episode; raises StoreError, also where none are kept."""
        raise StoreError(
            f"{self.address} keeps no marks; merge it into a directory of this machine and "
            "mark it there"
        )

    def summary(self, name: str) -> EpisodeSummary:
        """Return one episode at a glance; raises StoreError where its header cannot be read."""
        return self.unmarked_summary(name).marked(self.marks(name))

    def unmarked_summary(self, name: str) -> EpisodeSummary:
        """Return the same but for what a person said of it afterwards."""
        return EpisodeSummary.of(name, self.header(name), sum(self.files(name).values()))

    def summaries(self) -> Iterator[EpisodeSummary | StoreError]:
        """Yield each episode at a glance, sorted by name, or what is wrong with its header."""
        for name in self.names():
            try:
                yield self.summary(name)
            except StoreError as error:
                yield error

    def moments(self, name: str) -> EpisodeMoments:
        """Return the episode's takeovers and near misses; raises StoreError where it is damaged."""
        header = self.header(name)
        specs = [spec for spec in layout(header) if spec.path in COLUMNS]
        with self.opened(name) as content:
            arrays = {spec.path: read_array(name, spec, content) for spec in specs}
        return EpisodeMoments.of(header, arrays)

    def infos(self) -> list[EpisodeSummary]:
        """Return all episodes at a glance, sorted by name; raises StoreError as `summary` does."""
        found = []
        for summary in self.summaries():
            if isinstance(summary, StoreError):
                raise summary
            found.append(summary)
        return found

    def recorded(self, name: str, need_images: bool = True) -> Recorded:
        """The episode by column; raises StoreError where it is damaged.

        Without `need_images` no image is decompressed, and the arrays of images are not there.
        """
        header = self.header(name)
        wanted = [spec for spec in layout(header) if need_images or not spec.is_image]
        require_memory(name, "the episode", sum(spec.bytes for spec in wanted))
        with self.opened(name) as content:
            arrays = {spec.path: read_array(name, spec, content) for spec in wanted}
        require_sound(header, arrays)
        return Recorded(header, arrays)

    def read(self, name: str, need_images: bool = True) -> Episode:
        """The episode as it was recorded, to the bit; raises StoreError where it is damaged.

        Without `need_images` no image is decompressed and every `Observation.images` is empty.
        """
        recorded = self.recorded(name, need_images)
        return episode_from(recorded.header, recorded.arrays)

    def read_many(self, names: Iterable[str], need_images: bool = True) -> Iterator[Episode]:
        """The named episodes, each read when it is asked for; raises StoreError as `read` does."""
        return (self.read(name, need_images) for name in names)

    def learnable(self, names: Iterable[str]) -> Iterator[Episode]:
        """Yield what `read_many` does, with no label where a person marked an episode as bad."""
        return (learnable(self.read(name), self.marks(name)) for name in names)

    def episodes(
        self,
        purpose: Purpose | None = None,
        method: str | None = None,
        round: int | None = None,
        run_seed: int | None = None,
        need_images: bool = True,
    ) -> Iterator[Episode]:
        """The episodes that match all that is given, in the order (round, index, name).

        Those that were cut short are no results, and left out.
        """
        wanted = {"purpose": purpose, "method": method, "round": round, "run_seed": run_seed}
        found = [each for each in self.infos() if each.recorded_outcome is not Outcome.ERROR]
        matching = [
            (each.info.round, each.info.index, each.name)
            for each in found
            if all(value in (None, getattr(each.info, key)) for key, value in wanted.items())
        ]
        return self.read_many((name for *_, name in sorted(matching)), need_images)


def no_such_episode(address: str, name: str) -> StoreError:
    """The error for a name that is none of the episodes at `address`."""
    return StoreError(f"{address} has no episode {name!r}; `sheath data list` shows all")
