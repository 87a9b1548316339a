"""diffusion_policy's and UMI's ReplayBuffer: all episodes end to end in zarr arrays of format 2.

| array | meaning |
|---|---|
| `data/action` | (N, a) float32, the action that was chosen for export |
| `data/image_CAMERA` | (N, h, w, 3) uint8 |
| `data/NAME` | every other array of `layout`, by its name there |
| `data/limited` | (N, l) float64 where a limit acted anywhere: by how much, by limit; else NaN |
| `meta/episode_ends` | (E,) int64, the number of steps up to and with each episode |
| `meta/final_NAME` | (E, ...) what was observed after each episode's last action |
| `meta/terminated`, `meta/truncated`, `meta/success` | (E,) bool |

Their readers are of zarr 2, take the arrays in `data` for as long as the last of `episode_ends`,
and want both groups flat. The attribute `sheath` holds the header of each episode, and names the
columns of `data/limited`.
"""

import shutil
import zipfile
from collections import defaultdict
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import zarr
from numcodecs import Zstd
from numpy.typing import NDArray
from zarr.storage import LocalStore, ZipStore

from sheath_manip.dataset.attributes import from_attributes, to_attributes
from sheath_manip.dataset.exchange.formats import Format
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.track import DefaultKeys, Track, one_line
from sheath_manip.dataset.exchange.uniform import uniform
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import FRAMES_PER_CHUNK, layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Outcome

ATTRIBUTE = "sheath"
LIMITED = "limited"
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)
"""The earliest that a zip can tell: the same episodes shall make the same file."""


def write(target: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    """Write `episodes` to `target`: a zip where its name ends so, else a directory."""
    folder = target.with_name(f"{target.name}.d") if target.suffix == ".zip" else target
    _write_folder(folder, episodes, action)
    if folder != target:
        _pack(folder, target)
        shutil.rmtree(folder)


def _write_folder(folder: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    root = zarr.create_group(folder, zarr_format=2)
    data, meta = (_Columns(root.create_group(name)) for name in ("data", "meta"))
    headers: list[Header] = []
    limited: list[NDArray | None] = []
    ends, finals = [0], defaultdict[str, list[NDArray]](list)
    for recorded in uniform(episodes):
        header, arrays = recorded.header, recorded.arrays
        for spec in layout(header):
            if spec.path.startswith("final/"):
                finals[flat(spec.path)].append(arrays[spec.path])
            elif spec.path != LIMITED:
                data.append(flat(spec.path), arrays[spec.path])
        data.append("action", arrays[action])
        limited.append(arrays.get(LIMITED))
        finals["terminated"].append(np.array(header.terminated))
        finals["truncated"].append(np.array(header.truncated))
        finals["success"].append(np.array(header.outcome is Outcome.SUCCESS))
        ends.append(ends[-1] + header.length)
        headers.append(header)
    meta.append("episode_ends", np.array(ends[1:], np.int64))
    for name, values in finals.items():
        meta.append(name, np.stack(values))
    limits = sorted({limit for header in headers for limit in header.limits})
    if limits:
        data.append(LIMITED, _common(headers, limited, limits))
    root.attrs[ATTRIBUTE] = {
        "action": action.value,
        "limits": limits,
        "episodes": [to_attributes(header) for header in headers],
    }


def _common(
    headers: list[Header], limited: list[NDArray | None], limits: list[str]
) -> NDArray[np.float64]:
    """(N, l): each episode names only the limits that acted in it."""
    parts = []
    for header, values in zip(headers, limited, strict=True):
        part = np.full((header.length, len(limits)), np.nan)
        if values is not None:
            part[:, [limits.index(limit) for limit in header.limits]] = values
        parts.append(part)
    return np.concatenate(parts)


def flat(path: str) -> str:
    """The name of an array of `layout` in a flat group."""
    return path.replace("images/", "image_").replace("/", "_")


class _Columns:
    """A flat group whose arrays grow by rows."""

    def __init__(self, group: zarr.Group) -> None:
        self.group = group
        # An array that is opened again has forgotten that it is to write chunks of zeros too.
        self._arrays: dict[str, zarr.Array] = {}

    def append(self, name: str, values: NDArray) -> None:
        if name in self._arrays:
            self._arrays[name].append(values)
            return
        self._arrays[name] = self.group.create_array(
            name,
            data=np.ascontiguousarray(values),
            chunks=(FRAMES_PER_CHUNK, *(max(1, size) for size in values.shape[1:])),
            compressors=Zstd(level=1),
            config={"write_empty_chunks": True},
        )


def _pack(folder: Path, target: Path) -> None:
    # The chunks are compressed already.
    with zipfile.ZipFile(target, "w", zipfile.ZIP_STORED) as archive:
        for file in sorted(folder.rglob("*")):
            if file.is_file():
                name = file.relative_to(folder).as_posix()
                archive.writestr(zipfile.ZipInfo(name, _ZIP_DATE), file.read_bytes())


class ReplayBufferFile:
    """A ReplayBuffer to import, ours or another's; raises StoreError where `path` is none."""

    default_keys: ClassVar[DefaultKeys] = {"action": ("action",)}

    def __init__(self, path: Path) -> None:
        self.path = path
        if not path.exists():
            raise StoreError(f"wanted a ReplayBuffer at {path}, found nothing")
        with one_line(path, "a ReplayBuffer"):
            store = ZipStore(path, mode="r") if path.is_file() else LocalStore(path, read_only=True)
            self._root = zarr.open_group(store, mode="r", zarr_format=2)
            self._ends = np.asarray(self._array("meta", "episode_ends")[:])
            self._keys = tuple(sorted(self._group("data").array_keys()))
        if self._ends.ndim != 1 or np.any(np.diff(self._ends, prepend=0) < 1):
            raise StoreError(
                f"{path}: meta/episode_ends is {self._ends.tolist()!r:.60}; wanted ascending steps"
            )
        lengths = {key: self._array("data", key).shape[:1] for key in self._keys}
        for key, length in lengths.items():
            if self._ends.size and (not length or length[0] < self._ends[-1]):
                raise StoreError(
                    f"{path}: data/{key} has {length[0] if length else 'no'} steps, "
                    f"meta/episode_ends tells of {self._ends[-1]}"
                )

    def recorded(self) -> Iterator[Recorded] | None:
        """The episodes as they were exported, or None where another tool wrote the file."""
        ours = self._root.attrs.asdict().get(ATTRIBUTE)
        return None if ours is None else self._ours(ours)

    def tracks(self) -> Iterator[Track]:
        """Each episode by the file's own keys."""
        for start, stop in zip([0, *self._ends[:-1].tolist()], self._ends.tolist(), strict=True):
            yield Track(
                length=stop - start,
                keys=self._keys,
                read=lambda key, start=start, stop=stop: self._read("data", key, start, stop),
                final=lambda _: None,
            )

    def _ours(self, ours: Any) -> Iterator[Recorded]:
        with one_line(self.path, "a ReplayBuffer of sheath-manip"):
            attributes = list(ours["episodes"])
            limits = list(ours["limits"])
        if len(attributes) != len(self._ends):
            raise StoreError(
                f"{self.path} has {len(attributes)} headers for {len(self._ends)} episodes"
            )
        self._require_whole()
        start = 0
        for number, (entry, stop) in enumerate(zip(attributes, self._ends.tolist(), strict=True)):
            header = from_attributes(f"episode {number} of {self.path}", entry)
            arrays = {}
            for spec in layout(header):
                if spec.path.startswith("final/"):
                    arrays[spec.path] = self._read("meta", flat(spec.path), number, number + 1)[0]
                else:
                    arrays[spec.path] = self._read("data", flat(spec.path), start, stop)
            if header.limits:
                with one_line(self.path, "the limits of every episode"):
                    columns = [limits.index(limit) for limit in header.limits]
                    arrays[LIMITED] = arrays[LIMITED][:, columns]
            yield Recorded(header, arrays)
            start = stop

    def _require_whole(self) -> None:
        # zarr itself would fill the gap with zeros. Others leave chunks of zeros out; we do not.
        with one_line(self.path, "a ReplayBuffer of sheath-manip"):
            for group in ("data", "meta"):
                for name, array in self._group(group).arrays():
                    if array.nchunks_initialized != array.nchunks:
                        raise StoreError(
                            f"{self.path}: {group}/{name} has {array.nchunks_initialized} of "
                            f"{array.nchunks} chunks; copy or export it again"
                        )

    def _read(self, group: str, key: str, start: int, stop: int) -> NDArray:
        with one_line(self.path, "a ReplayBuffer"):
            return np.asarray(self._array(group, key)[start:stop])

    def _group(self, name: str) -> zarr.Group:
        group = self._root[name]
        if not isinstance(group, zarr.Group):
            raise StoreError(f"{self.path}: {name} is no group")
        return group

    def _array(self, group: str, key: str) -> zarr.Array:
        array = self._group(group)[key]
        if not isinstance(array, zarr.Array):
            raise StoreError(f"{self.path}: {group}/{key} is no array")
        return array


FORMAT = Format(write, ReplayBufferFile)
