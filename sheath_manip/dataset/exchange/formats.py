"""The formats that are known here, each imported only when it is asked for."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, Self, runtime_checkable

from sheath_manip.dataset.exchange.limits import MOST_TIMES_LARGER, Limits, stored_bytes
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.track import DefaultKeys, Track
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import ParameterError
from sheath_manip.registry import Registry

Writer = Callable[[Path, Iterable[Recorded], ActionChoice], None]
"""Writes episodes to a path where nothing is; raises StoreError where the format has no place."""


class ForeignFile(Protocol):
    """A file of another tool's format, ours or another's; its constructor takes its path."""

    @property
    def default_keys(self) -> DefaultKeys:
        """What the format's own names mean."""
        ...

    def recorded(self) -> Iterator[Recorded] | None:
        """The episodes as they were exported, or None where another tool wrote the file."""
        ...

    def tracks(self) -> Iterator[Track]:
        """Each episode by the file's own keys."""
        ...


@runtime_checkable
class SaysRate(Protocol):
    """A file that may say at which rate it was recorded."""

    @property
    def control_rate_hz(self) -> float | None:
        """Control steps a second; None where the file does not say."""
        ...


@runtime_checkable
class SaysTask(Protocol):
    """A file that may name the task of all its episodes."""

    @property
    def task(self) -> str | None:
        """The name; None where the file does not say, or names several."""
        ...


@runtime_checkable
class HasMasks(Protocol):
    """A file that lists some of its episodes by name, such as those to train on."""

    @property
    def masks(self) -> tuple[str, ...]:
        """The names of the lists."""
        ...

    def only(self, mask: str) -> Self:
        """Return the file with the episodes of a list alone; raises ParameterError for none."""
        ...


@runtime_checkable
class Sealed(Protocol):
    """A file that may hold a digest of each of its episodes."""

    @property
    def is_sealed(self) -> bool:
        """Whether it does: then a changed bit is found."""
        ...


@dataclass(frozen=True)
class Format:
    """What can be done with another tool's files."""

    write: Writer | None = None
    """None where nothing is written for it"""
    open: Callable[[Path], ForeignFile] | None = None
    """from the path, StoreError where it is no such file; None where nothing is read of it"""
    locate: Callable[[Path], Path] = Path
    """from a path, or the name of what the format's own tool keeps, to where that lies"""
    times_larger: int = MOST_TIMES_LARGER
    """as its bytes an episode may be in memory"""


_HERE = "sheath_manip.dataset.exchange"

FORMATS: Registry[Format] = Registry(
    "format",
    "sheath.formats",
    {
        "replay-buffer": f"{_HERE}.replay_buffer:FORMAT",
        "robomimic": f"{_HERE}.robomimic:FORMAT",
        "lerobot": f"{_HERE}.lerobot:FORMAT",
        "minari": f"{_HERE}.minari:FORMAT",
    },
    of=Format,
)


def writer_of(name: str) -> Writer:
    """Return what writes the format.

    Raises UnknownNameError, ParameterError where nothing is written for it, and SetupError where
    its package is not installed.
    """
    write = FORMATS[name].write
    if write is None:
        raise ParameterError(f"nothing is written as {name}; wanted a format such as robomimic")
    return write


def limits_of(name: str, path: Path) -> Limits:
    """Return what reading a file of the format may take; raises StoreError where there is none."""
    return Limits(path, stored_bytes(path), FORMATS[name].times_larger)


def located(name: str, path: Path) -> Path:
    """Return where a file of the format lies; raises as `open_file`."""
    return FORMATS[name].locate(path)


def open_file(name: str, path: Path) -> ForeignFile:
    """Open another tool's file at `path`.

    Raises UnknownNameError, ParameterError where nothing is read of the format, StoreError where
    `path` is no such file, and SetupError where the format's package is not installed.
    """
    opened = FORMATS[name].open
    if opened is None:
        raise ParameterError(f"nothing is read of {name}; wanted a format such as robomimic")
    return opened(path)
