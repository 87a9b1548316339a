"""Episodes of several stores in one, and of one store in several: copied, never moved."""

import shutil
import uuid
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sheath_manip.dataset.check import check_episode
from sheath_manip.dataset.durable import publish
from sheath_manip.dataset.faults import FaultError
from sheath_manip.dataset.naming import LEFTOVER_PREFIX
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError

if TYPE_CHECKING:
    from sheath_manip.dataset.remote import RemoteStore

Report = Callable[[str], None]


@dataclass(frozen=True)
class Merged:
    """What a merge did."""

    copied: int
    held: int
    """episodes that the target had already, the same to the byte"""


def merge(
    sources: Sequence[EpisodeReader],
    target: "EpisodeStore | RemoteStore",
    report: Report = lambda _: None,
) -> Merged:
    """Copy the episodes of all `sources` into `target`, whose own stay as they are.

    Raises StoreError, before anything is copied, where two episodes of one name differ, where one
    is of another task, and where one is damaged. A merge that was cut off can be run again.
    """
    task = ""
    held_names, plan, held = set(target.names()), dict[str, EpisodeReader](), 0
    for reader in (target, *sources):
        for name in reader.names():
            header = reader.header(name)
            task = task or header.info.task
            if header.info.task != task:
                raise StoreError(
                    f"{reader.address} holds {name} of task {header.info.task!r}, others are of "
                    f"{task!r}; one store holds one task"
                )
            if reader is target:
                continue
            other = target if name in held_names else plan.get(name)
            if other is not None:
                _require_same(reader, other, name)
                held += 1
                continue
            for fault in check_episode(reader, name):
                raise FaultError(fault.name, fault.kind, fault.text)
            plan[name] = reader
    for name, reader in plan.items():
        target.copy_from(reader, name)
        report(name)
    return Merged(len(plan), held)


def split(
    reader: EpisodeReader,
    parts: Mapping[str, float],
    into: Path,
    rng: np.random.Generator,
    report: Report = lambda _: None,
) -> dict[str, list[str]]:
    """Copy each episode into one of the new stores `into`/PART, drawn by their shares.

    Returns the names by part. All stores appear at once or none does. Raises ParameterError for
    shares that do not add up to 1 or give a part no episode, and StoreError where `into` exists or
    an episode is damaged.
    """
    drawn = _drawn(reader, parts, rng)
    if into.exists():
        raise StoreError(f"{into} exists, and it is kept; give a directory that is new")
    aside = into.parent / f"{LEFTOVER_PREFIX}{uuid.uuid4().hex}"
    try:
        for part, names in drawn.items():
            store = EpisodeStore.create(aside / part)
            for name in names:
                for fault in check_episode(reader, name):
                    raise FaultError(fault.name, fault.kind, fault.text)
                store.copy_from(reader, name)
                report(name)
        publish(aside, into)
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    return drawn


def _drawn(
    reader: EpisodeReader, parts: Mapping[str, float], rng: np.random.Generator
) -> dict[str, list[str]]:
    shares = np.array(list(parts.values()))
    if not shares.size or (shares <= 0).any() or not np.isclose(shares.sum(), 1):
        raise ParameterError(
            f"the parts have the shares {shares.tolist()}; wanted positive ones that add up to 1, "
            "such as train=0.8 test=0.2"
        )
    for part in parts:
        if not part or Path(part).name != part or part.startswith("."):
            raise ParameterError(f"the part {part!r} is no plain name of a directory")
    names = reader.names()
    stops = np.round(np.cumsum(shares) * len(names)).astype(int)
    order = rng.permutation(len(names))
    pieces = np.split(order, stops[:-1])
    if any(not len(piece) for piece in pieces):
        raise ParameterError(
            f"{reader.address} has {len(names)} episodes, too few for the shares "
            f"{shares.tolist()}: a part would have none"
        )
    return {
        part: sorted(names[i] for i in piece) for part, piece in zip(parts, pieces, strict=True)
    }


def _require_same(reader: EpisodeReader, other: EpisodeReader, name: str) -> None:
    files = reader.files(name)
    if files != other.files(name) or any(
        reader.content(name, file) != other.content(name, file) for file in files
    ):
        raise StoreError(
            f"{reader.address} and {other.address} hold different episodes {name}; both are kept: "
            "`sheath data drop` one of them first"
        )
