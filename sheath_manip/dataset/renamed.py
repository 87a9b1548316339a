"""One episode of a store under the name of another session, its arrays untouched."""

from collections.abc import Mapping
from dataclasses import replace

from sheath_manip.dataset.attributes import GROUP_FILE, to_attributes
from sheath_manip.dataset.digests import Seals, sealed
from sheath_manip.dataset.faults import Fault
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.reader import LARGEST_FILE_BYTES, EpisodeReader
from sheath_manip.dataset.zarr_files import group_file


class OfSession(EpisodeReader):
    """The episode `inner` of `reader` as one of `session`: the only one of this place.

    Only the file of its header differs from what `reader` has. Raises StoreError where that header
    cannot be read.
    """

    def __init__(self, reader: EpisodeReader, inner: str, session: str) -> None:
        self._reader = reader
        self._inner = inner
        header = reader.header(inner)
        self._header = replace(header, info=replace(header.info, session=session))
        attributes = to_attributes(self._header)
        if self._header.digests is not None:
            attributes = sealed(attributes, Seals(self._header.digests, self._header.checksums))
        self._content = group_file(attributes)

    @property
    def address(self) -> str:
        """The place that it is read from."""
        return self._reader.address

    def names(self) -> list[str]:
        """The name that it has as one of the session."""
        return [episode_name(self._header.info)]

    def header(self, name: str) -> Header:  # noqa: ARG002
        """Return the episode's header, with the session."""
        return self._header

    def files(self, name: str) -> Mapping[str, int]:  # noqa: ARG002
        """The size in bytes of each of its files."""
        return {**self._reader.files(self._inner), GROUP_FILE: len(self._content)}

    def odd_files(self, name: str) -> Mapping[str, str]:  # noqa: ARG002
        """What is neither file nor folder in its folder."""
        return self._reader.odd_files(self._inner)

    def content(self, name: str, file: str, most_bytes: int = LARGEST_FILE_BYTES) -> bytes:  # noqa: ARG002
        """Return what is in one of the episode's files."""
        if file == GROUP_FILE:
            return self._content
        return self._reader.content(self._inner, file, most_bytes)

    def entry_faults(self) -> list[Fault]:
        """Return nothing, since nothing else is here."""
        return []

    def marks(self, name: str) -> Marks:  # noqa: ARG002
        """Return what a person said of the episode."""
        return self._reader.marks(self._inner)
