"""Mending what can be mended in a store without losing an episode."""

import shutil
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from sheath_manip.dataset.attributes import GROUP_FILE, MOST_BYTES, header_in
from sheath_manip.dataset.durable import sync
from sheath_manip.dataset.faults import FaultError
from sheath_manip.dataset.naming import LEFTOVER_PREFIX, episode_name
from sheath_manip.dataset.places import is_there, place_of
from sheath_manip.dataset.rooted_files import entries, entries_now, is_folder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError


@dataclass(frozen=True)
class Repaired:
    """What a repair did."""

    swept: tuple[str, ...]
    """leftovers that were deleted"""
    renamed: tuple[str, ...]
    """episodes that have their own name again"""
    waiting: tuple[str, ...]
    """leftovers that may still be written to"""


def repair(store: EpisodeStore, idle_s: float) -> Repaired:
    """Delete leftovers that nobody wrote to for `idle_s`, and give misnamed episodes their names.

    A damaged episode stays: only its name can say that it may go. Raises StoreError where the disk
    refuses, and ParameterError for an `idle_s` below 0.
    """
    if not idle_s >= 0:
        raise ParameterError(f"leftovers idle for {idle_s} s; wanted 0 or more")
    swept, renamed, waiting = [], [], []
    now_s = time.time()
    try:
        for entry, _ in entries_now(store.path):
            if not entry.name.startswith(LEFTOVER_PREFIX):
                continue
            # One that has gone meanwhile is an episode now, or was swept by another.
            with suppress(FileNotFoundError):
                if now_s - _last_written_s(entry) < idle_s:
                    waiting.append(entry.name)
                    continue
                shutil.rmtree(entry) if is_folder(entry) else entry.unlink()
                swept.append(entry.name)
        for name in store.names():
            own = _own_name(store, name)
            place = place_of(store.path, name)
            if own is not None and place is not None and not is_there(store.path, own):
                place.path.rename(place.path.with_name(place.path.name.replace(name, own, 1)))
                renamed.append(own)
        sync(store.path)
    except OSError as error:
        raise StoreError(f"cannot repair {store.path} ({error})") from error
    return Repaired(tuple(swept), tuple(renamed), tuple(waiting))


def _own_name(store: EpisodeStore, name: str) -> str | None:
    """The name that an episode's header tells of, where it has another."""
    try:
        own = episode_name(header_in(name, store.content(name, GROUP_FILE, MOST_BYTES)).info)
    except FaultError:
        return None
    return None if own == name else own


def _last_written_s(entry: Path) -> float:
    inside = (status for _, status in entries(entry)) if is_folder(entry) else ()
    return max(status.st_mtime for status in (entry.lstat(), *inside))
