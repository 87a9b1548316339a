"""One episode of another tool's file, before its keys are given a meaning."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from numpy.typing import NDArray

from sheath_manip.exceptions import SetupError, SheathError, StoreError
from sheath_manip.types import Outcome

DefaultKeys = Mapping[str, tuple[str, ...]]
"""what a format's own names mean, as in `KeyMap`"""


@dataclass(frozen=True)
class Ending:
    """How an episode ended, as far as a file says."""

    outcome: Outcome | None = None
    """None where the file does not say"""
    terminated: bool = True
    truncated: bool = False
    told_by: str = ""
    """the key that tells the outcome"""

    @classmethod
    def of(cls, key: str, success: NDArray, terminated: bool, truncated: bool) -> "Ending":
        """Return the ending of an episode that succeeded where any step of `success` says so.

        One that neither terminated nor was truncated was cut off.
        """
        failed = Outcome.FAILURE if terminated else Outcome.TIME_LIMIT
        outcome = Outcome.SUCCESS if success.any() else failed
        return cls(outcome, terminated, truncated or not terminated, key)


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
    ending: Ending = Ending()
    words: str = ""
    """what was to be done, in words; empty where the file does not say"""
    place: int | None = None
    """in the file, where only some of its episodes are taken; None: as they come"""
    beside: tuple[str, ...] = ()
    """what the file holds of it that no key can name"""


@contextmanager
def one_line(path: Path, wanted: str) -> Iterator[None]:
    """Whatever zarr, h5py and their codecs raise (they share no class) as one line."""
    try:
        yield
    except SetupError:
        # The file is as sound as it was.
        raise
    except SheathError as error:
        if str(path) in str(error):
            raise
        raise StoreError(f"wanted {wanted} at {path}: {error}") from error
    except Exception as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise StoreError(
            f"wanted {wanted} at {path}, which does not decode ({type(error).__name__}: {reason})"
        ) from error
