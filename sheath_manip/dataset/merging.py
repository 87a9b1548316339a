"""Episodes of several stores in one, and of one store in several: copied, never moved."""

import shutil
import uuid
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sheath_manip.dataset.check import require_sound_episode
from sheath_manip.dataset.compatibility import Alike, RecordedSpec, remarks
from sheath_manip.dataset.content import content_digest
from sheath_manip.dataset.durable import publish
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.naming import LEFTOVER_PREFIX, Scene, scene_of, split_session
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.renamed import OfSession
from sheath_manip.dataset.sessions import DIGITS
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
    """episodes that the target, or another source, had already with the same content"""
    renamed: tuple[str, ...] = ()
    """new names of episodes whose own one another episode had"""
    remarks: tuple[str, ...] = field(default=(), compare=False)
    """what must be told of episodes that may lie together all the same"""


def merge(
    sources: Sequence[EpisodeReader],
    target: "EpisodeStore | RemoteStore",
    report: Report = lambda _: None,
) -> Merged:
    """Copy the episodes of all `sources` into `target`, whose own stay as they are.

    What is there with the same content, under whatever session, is not copied again; where another
    episode has the name, as of two recordings by hand of one scene, it becomes one of a session
    that is named after its content. What a person said of an episode goes with it, also to one that
    is there already and of which nobody has said anything; where both were spoken of, the target's
    marks stay and a remark tells so. Raises StoreError, before anything is copied, where episodes
    do not fit each other, and where one is damaged. A merge that was cut off can be run again.
    """
    headers = _fitting((target, *sources))
    there = _There(target)
    plan, held, renamed = list[tuple[EpisodeReader, str]](), list[_Held](), list[str]()
    for reader in sources:
        for name in reader.names():
            same = there.same_as(reader, name)
            if same is not None:
                held.append(_Held(same, reader.address, reader.marks(name)))
                continue
            require_sound_episode(reader, name)
            if name in there:
                taken = OfSession(reader, name, content_digest(reader, name)[:DIGITS])
                (new,) = taken.names()
                renamed.append(new)
                plan.append((taken, new))
            else:
                plan.append((reader, name))
            there.add(*plan[-1])
    for reader, name in plan:
        target.copy_from(reader, name)
        report(name)
    marks_stay = list(_taking_marks_along(held, target)) if isinstance(target, EpisodeStore) else []
    kept = (
        headers.get((reader.address, name)) or reader.header(name)
        for name, reader in there.readers.items()
    )
    told = remarks((header.info.variant, RecordedSpec.of(header)) for header in kept)
    return Merged(len(plan), len(held), tuple(renamed), (*told, *marks_stay))


@dataclass(frozen=True)
class _Held:
    """An episode that need not be copied."""

    name: str
    """in the target"""
    source: str
    """address"""
    marks: Marks
    """in the source"""


def _taking_marks_along(held: Sequence[_Held], target: EpisodeStore) -> Iterator[str]:
    """Mark what nobody has marked in the target, and yield what is marked otherwise there."""
    for each in held:
        if each.marks == Marks():
            continue
        own = target.marks(each.name)
        if own == Marks():
            target.mark(each.name, each.marks)
        elif own != each.marks:
            yield f"{each.name} is marked otherwise in {each.source}; {target.path} keeps its marks"


class _There:
    """What the target of a merge will hold."""

    def __init__(self, target: EpisodeReader) -> None:
        self.readers: dict[str, EpisodeReader] = dict.fromkeys(target.names(), target)
        self._of_scene = defaultdict[str, list[str]](list)
        for name in self.readers:
            self._of_scene[split_session(name)[0]].append(name)

    def __contains__(self, name: str) -> bool:
        return name in self.readers

    def add(self, reader: EpisodeReader, name: str) -> None:
        """Note that the episode `name` of `reader` will be there."""
        self.readers[name] = reader
        self._of_scene[split_session(name)[0]].append(name)

    def same_as(self, reader: EpisodeReader, name: str) -> str | None:
        """Return which episode of the same scene has the content of `name` in `reader`, if any."""
        candidates = self._of_scene[split_session(name)[0]]
        # To compare files is far cheaper than to decompress them.
        if name in self and _same_files(reader, self.readers[name], name):
            return name
        if not candidates:
            return None
        digest = content_digest(reader, name)
        same = (each for each in candidates if content_digest(self.readers[each], each) == digest)
        return next(same, None)


def _fitting(readers: Sequence[EpisodeReader]) -> dict[tuple[str, str], Header]:
    """The headers of all episodes by place and name; raises StoreError where one does not fit."""
    headers, alike = {}, Alike("keep them in stores of their own; nothing was copied")
    for reader in readers:
        for name in reader.names():
            header = reader.header(name)
            alike.take(f"{name} of {reader.address}", RecordedSpec.of(header))
            headers[reader.address, name] = header
    return headers


def split(
    reader: EpisodeReader,
    parts: Mapping[str, float],
    into: Path,
    rng: np.random.Generator,
    report: Report = lambda _: None,
) -> dict[str, list[str]]:
    """Copy each episode into one of the new stores `into`/PART, drawn by their shares of scenes.

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
                require_sound_episode(reader, name)
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
    # By scene: what was recorded twice, or by several methods, is no news to the other part.
    scenes = defaultdict[Scene, list[str]](list)
    for name in reader.names():
        scenes[scene_of(reader.header(name).info)].append(name)
    names = list(scenes.values())
    stops = np.round(np.cumsum(shares) * len(names)).astype(int)
    order = rng.permutation(len(names))
    pieces = np.split(order, stops[:-1])
    if any(not len(piece) for piece in pieces):
        raise ParameterError(
            f"{reader.address} has episodes of {len(names)} scenes, too few for the shares "
            f"{shares.tolist()}: a part would have none"
        )
    return {
        part: sorted(name for i in piece for name in names[i])
        for part, piece in zip(parts, pieces, strict=True)
    }


def _same_files(reader: EpisodeReader, other: EpisodeReader, name: str) -> bool:
    files = reader.files(name)
    return files == other.files(name) and all(
        reader.content(name, file) == other.content(name, file) for file in files
    )
