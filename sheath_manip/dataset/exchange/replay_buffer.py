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
and want both groups flat. The attribute `sheath` holds the header and the digest of each episode,
and names the columns of `data/limited`.
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

from sheath_manip.dataset.attributes import from_attributes, to_attributes
from sheath_manip.dataset.exchange.formats import Format
from sheath_manip.dataset.exchange.limits import Limits, stored_bytes
from sheath_manip.dataset.exchange.plain_tree import FolderTree, PlainTree, ZipTree, read_json
from sheath_manip.dataset.exchange.sealing import digest_of, require_digest
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.track import DefaultKeys, Track, one_line
from sheath_manip.dataset.exchange.uniform import uniform
from sheath_manip.dataset.exchange.zarr2 import Zarr2Array
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import FRAMES_PER_CHUNK, layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Outcome

ATTRIBUTE = "sheath"
DIGESTS = "digests"
LIMITED = "limited"
GROUPS = ("data", "meta")
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
    digests: list[str] = []
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
        digests.append(digest_of(recorded))
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
        DIGESTS: digests,
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
        self._limits = Limits(path, stored_bytes(path))
        with one_line(path, "a ReplayBuffer"), self._limits.reading():
            self._tree: PlainTree = ZipTree(path) if path.is_file() else FolderTree(path)
            if read_json(self._tree, ".zgroup", self._limits).get("zarr_format") != 2:
                raise StoreError(f"{path} is no group of zarr's format 2")
            self._arrays = {
                f"{group}/{name}": Zarr2Array(self._tree, f"{group}/{name}", self._limits)
                for group, name in _array_names(self._tree)
            }
            self._stops = self._read_stops()
        self._keys = tuple(sorted(key[5:] for key in self._arrays if key.startswith("data/")))
        for key in self._keys:
            length, *_ = self._arrays[f"data/{key}"].shape
            if self._stops and length < self._stops[-1]:
                raise StoreError(
                    f"{path}: data/{key} has {length} steps, meta/episode_ends tells of "
                    f"{self._stops[-1]}"
                )

    def _read_stops(self) -> list[int]:
        """The number of steps up to and with each episode."""
        ends = self._array("meta", "episode_ends")
        told = ends.rows(0, ends.shape[0])
        stops = told.tolist() if told.ndim == 1 and told.dtype.kind in "iu" else None
        if stops is None or any(b <= a for a, b in zip([0, *stops], stops, strict=False)):
            raise StoreError(
                f"{self.path}: meta/episode_ends is {told.tolist()!r:.60}; wanted ascending steps"
            )
        return stops

    @property
    def is_sealed(self) -> bool:
        """Whether a digest tells what each episode was when it was written."""
        ours = self._attributes().get(ATTRIBUTE)
        return isinstance(ours, dict) and DIGESTS in ours

    def recorded(self) -> Iterator[Recorded] | None:
        """The episodes as they were exported, or None where another tool wrote the file."""
        self._limits.begin()
        ours = self._attributes().get(ATTRIBUTE)
        self._require_memory()
        return None if ours is None else self._ours(ours)

    def tracks(self) -> Iterator[Track]:
        """Each episode by the file's own keys."""
        for start, stop in zip([0, *self._stops], self._stops, strict=False):
            yield Track(
                length=stop - start,
                keys=self._keys,
                read=lambda key, start=start, stop=stop: self._read("data", key, start, stop),
                final=lambda _: None,
            )

    def _require_memory(self) -> None:
        row_bytes = sum(array.row_bytes for array in self._arrays.values())
        lengths = (b - a for a, b in zip([0, *self._stops], self._stops, strict=False))
        self._limits.require_memory("the longest episode", row_bytes * max(lengths, default=0))

    def _attributes(self) -> dict[str, Any]:
        if ".zattrs" not in self._tree.sizes:
            return {}
        with one_line(self.path, "a ReplayBuffer"):
            attributes = read_json(self._tree, ".zattrs", self._limits)
        if not isinstance(attributes, dict):
            raise StoreError(f"{self.path}: its attributes are no object")
        return attributes

    def _ours(self, ours: Any) -> Iterator[Recorded]:
        with one_line(self.path, "a ReplayBuffer of sheath-manip"):
            attributes = list(ours["episodes"])
            limits = list(ours["limits"])
            digests = list(ours.get(DIGESTS, [None] * len(attributes)))
        if not len(attributes) == len(digests) == len(self._stops):
            raise StoreError(
                f"{self.path} has {len(attributes)} headers and {len(digests)} digests for "
                f"{len(self._stops)} episodes"
            )
        self._require_whole()
        starts = [0, *self._stops[:-1]]
        for number, (entry, start, stop) in enumerate(
            zip(attributes, starts, self._stops, strict=True)
        ):
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
            recorded = Recorded(header, arrays)
            require_digest(f"episode {number} of {self.path}", recorded, digests[number])
            yield recorded

    def _require_whole(self) -> None:
        # A chunk that is missing would be filled up with zeros. Others leave chunks of zeros out;
        # we do not.
        for name, array in self._arrays.items():
            if missing := array.missing():
                raise StoreError(
                    f"{self.path}: {missing} chunks of {name} are missing; copy or export it again"
                )

    def _read(self, group: str, key: str, start: int, stop: int) -> NDArray:
        with one_line(self.path, f"an array {group}/{key}"), self._limits.reading():
            return self._array(group, key).rows(start, stop)

    def _array(self, group: str, key: str) -> Zarr2Array:
        if f"{group}/{key}" not in self._arrays:
            raise StoreError(f"{self.path} has no array {group}/{key}")
        return self._arrays[f"{group}/{key}"]


def _array_names(tree: PlainTree) -> list[tuple[str, str]]:
    """Group and name of each array in `data` and `meta`, both flat."""
    files = (file.split("/") for file in tree.sizes if file.endswith("/.zarray"))
    return sorted((file[0], file[1]) for file in files if len(file) == 3 and file[0] in GROUPS)


FORMAT = Format(write, ReplayBufferFile)
