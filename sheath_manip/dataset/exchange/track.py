"""One episode of another tool's file, before its keys are given a meaning."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from numpy.typing import NDArray

from sheath_manip.exceptions import SheathError, StoreError

DefaultKeys = Mapping[str, tuple[str, ...]]
"""what a format's own names mean, as in `KeyMap`"""


@dataclass(frozen=True)
class Track:
    """An episode of T steps by the file's own keys; what they mean only the user knows."""

    length: int
    """T"""
    keys: tuple[str, ...]
    read: Callable[[str], NDArray]
    """(T, ...) the values of a key; raises StoreError where they do not decode"""
    final: Callable[[str], NDArray | None]
    """the value of a key after the last action, without T; None where the file has none"""


@contextmanager
def one_line(path: Path, wanted: str) -> Iterator[None]:
    """Whatever zarr, h5py and their codecs raise (they share no class) as one line."""
    try:
        yield
    except SheathError as error:
        if str(path) in str(error):
            raise
        raise StoreError(f"wanted {wanted} at {path}: {error}") from error
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise StoreError(
            f"wanted {wanted} at {path}, which does not decode ({type(error).__name__}: {reason})"
        ) from error
