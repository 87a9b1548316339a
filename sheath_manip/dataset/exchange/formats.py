"""The formats that are known here, each imported only when it is asked for."""

from collections.abc import Callable, Iterable, Iterator
from enum import StrEnum
from importlib import import_module
from pathlib import Path
from typing import ClassVar, Protocol

from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.track import DefaultKeys, Track
from sheath_manip.dataset.recorded import Recorded

Writer = Callable[[Path, Iterable[Recorded], ActionChoice], None]
"""Writes episodes to a path where nothing is; raises StoreError where the format has no place."""


class ForeignFile(Protocol):
    """A file of another tool's format, ours or another's; its constructor takes its path."""

    default_keys: ClassVar[DefaultKeys]
    """what the format's own names mean"""

    def recorded(self) -> Iterator[Recorded] | None:
        """The episodes as they were exported, or None where another tool wrote the file."""
        ...

    def tracks(self) -> Iterator[Track]:
        """Each episode by the file's own keys."""
        ...


class ExportFormat(StrEnum):
    """What can be written."""

    REPLAY_BUFFER = "replay-buffer"
    ROBOMIMIC = "robomimic"
    LEROBOT = "lerobot"
    MINARI = "minari"

    def writer(self) -> Writer:
        """Raises SetupError where the format's package is not installed."""
        name = self.value.replace("-", "_")
        return import_module(f"sheath_manip.dataset.exchange.{name}").write


class ImportFormat(StrEnum):
    """What can be read."""

    REPLAY_BUFFER = "replay-buffer"
    ROBOMIMIC = "robomimic"

    def open(self, path: Path) -> ForeignFile:
        """Raises StoreError where `path` is no such file, SetupError as `ExportFormat.writer`."""
        if self is ImportFormat.REPLAY_BUFFER:
            from sheath_manip.dataset.exchange.replay_buffer import ReplayBufferFile

            return ReplayBufferFile(path)
        from sheath_manip.dataset.exchange.robomimic import RobomimicFile

        return RobomimicFile(path)
