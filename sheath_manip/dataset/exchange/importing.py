"""Taking in the episodes of another tool's file."""

import os
import shutil
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from sheath_manip.dataset.compatibility import Alike, RecordedSpec
from sheath_manip.dataset.durable import publish
from sheath_manip.dataset.exchange.formats import ForeignFile, SaysRate, Sealed
from sheath_manip.dataset.exchange.key_map import KeyMap, interpret, numbered
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.naming import LEFTOVER_PREFIX, episode_name
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, SetupError, SheathError, StoreError
from sheath_manip.types import EpisodeInfo, Outcome


@dataclass(frozen=True)
class Origin:
    """What a file of another tool does not tell of its episodes, and the user must."""

    info: EpisodeInfo
    """of all of them, but for `seed` and `index`, which count them"""
    outcome: Outcome
    """of all of them"""
    keys: KeyMap


@dataclass(frozen=True)
class Imported:
    """What was taken in."""

    added: int
    held: int
    """episodes that the store had already"""
    sealed: bool = False
    """whether a digest told that each episode is what was written into the file"""


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
    of the same name; ParameterError where another tool wrote the file and there is no `origin`, or
    one of another control rate than the file says.
    """
    alike, example = Alike("import it into a store of its own"), store.example()
    if example is not None:
        alike.take(*example)
    # Swept away as a recording that was cut off, should this process be.
    aside = store.path / f"{_prefix(os.getpid())}{uuid.uuid4().hex}"
    number = held = 0
    try:
        staged = EpisodeStore.create(aside)
        for recorded in _recorded(file, origin):
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
        return Imported(_published(staged, store), held, _is_sealed(file))
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
            publish(staged.path / name, store.path / name)
            done.append(name)
    except BaseException:
        for name in done:
            store.drop(name)
        raise
    return len(done)


def _is_sealed(file: ForeignFile) -> bool:
    return isinstance(file, Sealed) and file.is_sealed


def _recorded(file: ForeignFile, origin: Origin | None) -> Iterator[Recorded]:
    ours = file.recorded()
    if ours is not None:
        yield from ours
        return
    if origin is not None and isinstance(file, SaysRate):
        told_hz, said_hz = origin.info.control_rate_hz, file.control_rate_hz
        if said_hz not in (None, told_hz):
            raise ParameterError(
                f"the file says that it was recorded at {said_hz:g} Hz, not at {told_hz:g} Hz; "
                f"give --control-rate-hz {said_hz:g}"
            )
    if origin is None:
        raise ParameterError(
            "another tool wrote this file, which tells neither task nor control rate; give --task "
            "and --control-rate-hz, and --keys for its observations"
        )
    for number, track in enumerate(file.tracks()):
        keys = origin.keys.over(file.default_keys, track)
        yield interpret(track, numbered(origin.info, number), origin.outcome, keys)


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
