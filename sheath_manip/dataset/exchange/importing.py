"""Taking in the episodes of another tool's file."""

import os
import shutil
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

from sheath_manip.dataset.archive import give_name
from sheath_manip.dataset.compatibility import Alike, RecordedSpec
from sheath_manip.dataset.exchange.formats import (
    ForeignFile,
    HasMasks,
    SaysRate,
    SaysTask,
    Sealed,
)
from sheath_manip.dataset.exchange.key_map import KeyMap, interpret, numbered
from sheath_manip.dataset.header import LEAST_RATE_HZ, MOST_RATE_HZ, is_rate
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.naming import LEFTOVER_PREFIX, episode_name
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, SetupError, SheathError, StoreError
from sheath_manip.types import EpisodeInfo, Outcome, Purpose


@dataclass(frozen=True)
class Origin:
    """What a file of another tool does not tell of its episodes, and the user must."""

    info: EpisodeInfo
    """of all of them, but for `seed` and `index`, which count them; an empty task and a control
    rate of 0 are those that the file says, an empty variant the words of each episode's task"""
    outcome: Outcome | None
    """of all of them; None: as the file says of each, success where it does not"""
    keys: KeyMap
    mask: str = ""
    """only the episodes of that list of the file; empty: all"""


NOTHING_TOLD = Origin(
    EpisodeInfo("", 0, Purpose.DEMONSTRATION, 0.0, method="imported", variant=""), None, KeyMap({})
)


@dataclass(frozen=True)
class Imported:
    """What was taken in."""

    added: int
    held: int
    """episodes that the store had already"""
    sealed: bool = False
    """whether a digest told that each episode is what was written into the file"""
    remarks: tuple[str, ...] = field(default=(), compare=False)
    """lines that say what was taken of another tool's file, and what was not"""


def import_episodes(
    file: ForeignFile,
    store: EpisodeStore,
    origin: Origin | None,
    report: Callable[[str], None] = lambda _: None,
) -> Imported:
    """Append the episodes of `file` to `store`, but for those that it holds: all or none.

    What this project exported comes back as it was, whatever `origin` says. An import that was cut
    off can be run again. Raises StoreError, with nothing imported, where the file is damaged or
    holds no episode, asks for more memory or time than a file of its size may, where a key is
    missing, where an episode does not fit those of the store, and where that holds another episode
    of the same name; ParameterError where neither the file nor `origin` says task and control rate,
    where they say another rate, and where the file has no such mask.
    """
    alike, example = Alike("import it into a store of its own"), store.example()
    if example is not None:
        alike.take(*example)
    # Swept away as a recording that was cut off, should this process be.
    aside = store.path / f"{_prefix(os.getpid())}{uuid.uuid4().hex}"
    number = held = 0
    remarks: list[str] = []
    try:
        staged = EpisodeStore.create(aside)
        for recorded in _recorded(file, origin or NOTHING_TOLD, remarks):
            info = recorded.header.info
            alike.take(episode_name(info), RecordedSpec.of(recorded.header))
            holder = next((each for each in (store, staged) if each.has(info)), None)
            if holder is None:
                staged.append_arrays(recorded)
            else:
                _require_same(holder, recorded)
                held += 1
            report(episode_name(info))
            number += 1
        if not number:
            raise StoreError("the file holds no episode; wanted at least one to import")
        return Imported(_published(staged, store), held, _is_sealed(file), tuple(remarks))
    except (ParameterError, SetupError):
        raise
    except Exception as error:
        # Readers of other packages, and arrays that nobody foresaw, raise what they like.
        said = str(error) if isinstance(error, SheathError) else f"{type(error).__name__}: {error}"
        raise StoreError(
            f"nothing is imported: episode {number} of the file: {' '.join(said.split())[:600]}"
        ) from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)


def staging_of(store: Path, process_id: int) -> list[Path]:
    """Return the folders of a store in which a process has put aside what it imports."""
    return list(store.glob(f"{_prefix(process_id)}*"))


def _prefix(process_id: int) -> str:
    return f"{LEFTOVER_PREFIX}import-{process_id}-"


def _published(staged: EpisodeStore, store: EpisodeStore) -> int:
    """Give all that is staged its place in the store, or none of it."""
    done: list[str] = []
    try:
        for name in staged.names():
            give_name(archive_path(staged.path, name), archive_path(store.path, name))
            done.append(name)
    except BaseException:
        for name in done:
            store.drop(name)
        raise
    return len(done)


def _is_sealed(file: ForeignFile) -> bool:
    return isinstance(file, Sealed) and file.is_sealed


def _recorded(file: ForeignFile, origin: Origin, remarks: list[str]) -> Iterator[Recorded]:
    """Yield the episodes; of another tool's the `remarks` are told when the first is there."""
    if origin.mask:
        file = _masked(file, origin.mask)
    ours = file.recorded()
    if ours is not None:
        yield from ours
        return
    info = _completed(file, origin.info)
    for number, track in enumerate(file.tracks()):
        keys = origin.keys.over(file.default_keys, track)
        words = track.words if track.words != info.task else ""
        place = number if track.place is None else track.place
        each = replace(numbered(info, place), variant=info.variant or words)
        outcome = origin.outcome or track.ending.outcome or Outcome.SUCCESS
        yield interpret(track, each, outcome, keys)
        if number == 0:
            outcome_by = "" if origin.outcome else track.ending.told_by
            remarks.extend(keys.remarks(track, outcome_by))
            if isinstance(file, HasMasks) and file.masks and not origin.mask:
                listed = ", ".join(file.masks)
                remarks.append(f"all episodes are taken; --mask takes those of a list: {listed}")


def _masked(file: ForeignFile, mask: str) -> ForeignFile:
    masks = file.masks if isinstance(file, HasMasks) else ()
    if not isinstance(file, HasMasks) or mask not in masks:
        listed = f"wanted one of {', '.join(masks)}" if masks else "it has none"
        raise ParameterError(f"the file has no list {mask!r} of episodes; {listed}")
    return file.only(mask)


def _completed(file: ForeignFile, info: EpisodeInfo) -> EpisodeInfo:
    """The info with the task and rate that the file says; ParameterError where nobody does."""
    task = info.task or (file.task if isinstance(file, SaysTask) else None)
    said_hz = file.control_rate_hz if isinstance(file, SaysRate) else None
    rate_hz = info.control_rate_hz or said_hz
    if said_hz not in (None, rate_hz):
        raise ParameterError(
            f"the file says that it was recorded at {said_hz:g} Hz, not at {rate_hz:g} Hz; "
            f"give --control-rate-hz {said_hz:g}"
        )
    if not task or rate_hz is None:
        wanted = {} if task else {"one task": "--task"}
        wanted |= {} if rate_hz else {"its control rate": "--control-rate-hz"}
        raise ParameterError(
            f"another tool wrote this file, which does not tell {' and '.join(wanted)}; give "
            f"{' and '.join(wanted.values())}, and --keys for what it calls otherwise"
        )
    if not is_rate(rate_hz):
        raise StoreError(
            f"the file tells a control rate of {rate_hz:g} Hz; wanted {LEAST_RATE_HZ:g} .. "
            f"{MOST_RATE_HZ:g}"
        )
    return replace(info, task=task, control_rate_hz=rate_hz)


def _require_same(store: EpisodeStore, recorded: Recorded) -> None:
    """Raise StoreError unless the store's episode of that name holds the same arrays."""
    name = episode_name(recorded.header.info)
    held = store.recorded(name)
    # By bytes: NaN is no other than NaN here.
    paths = [spec.path for spec in layout(held.header)]
    if (
        held.header.outcome is not recorded.header.outcome
        or _shapes(held) != _shapes(recorded)
        or any(held.arrays[path].tobytes() != recorded.arrays[path].tobytes() for path in paths)
    ):
        raise StoreError(
            f"{store.path} holds another episode {name}, and it is kept; import under another "
            "--method or into a new store"
        )


def _shapes(recorded: Recorded) -> list[tuple[str, tuple[int, ...], str]]:
    return [(spec.path, spec.shape, spec.dtype) for spec in layout(recorded.header)]
