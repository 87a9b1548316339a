"""Reading ReplayBuffers, in zarr's format 2 or 3; `replay_buffer` says what ours hold."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from sheath_manip.dataset.attributes import from_attributes
from sheath_manip.dataset.exchange import zarr2, zarr3
from sheath_manip.dataset.exchange.limits import Limits, stored_bytes
from sheath_manip.dataset.exchange.plain_tree import FolderTree, PlainTree, ZipTree, read_json
from sheath_manip.dataset.exchange.replay_buffer_writing import ATTRIBUTE, DIGESTS, flat
from sheath_manip.dataset.exchange.sealing import require_digest
from sheath_manip.dataset.exchange.track import DefaultKeys, Track, one_line
from sheath_manip.dataset.exchange.zarr_array import ZarrArray
from sheath_manip.dataset.layout import LIMITED, SIGNALS, layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError

GROUPS = ("data", "meta")


class ReplayBufferFile:
    """A ReplayBuffer to import, ours or another's; raises StoreError where `path` is none."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._limits = Limits(path, stored_bytes(path))
        with one_line(path, "a ReplayBuffer"), self._limits.reading():
            self._tree: PlainTree = ZipTree(path) if path.is_file() else FolderTree(path)
            self._is_new = zarr3.NODE in self._tree.sizes
            told = read_json(self._tree, zarr3.NODE if self._is_new else zarr2.GROUP, self._limits)
            is_group = zarr3.is_group(told) if self._is_new else told.get("zarr_format") == 2
            if not is_group:
                raise StoreError(f"{path} is no group of zarr's format 2 or 3")
            zarr = zarr3 if self._is_new else zarr2
            self._arrays = {
                path: ZarrArray(
                    self._tree, path, zarr.read_meta(self._tree, path, self._limits), self._limits
                )
                for path in _array_paths(self._tree, self._is_new)
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

    @property
    def default_keys(self) -> DefaultKeys:
        """The action alone has a name that all agree on."""
        return {"action": ("action",)}

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
        file = zarr3.NODE if self._is_new else zarr2.ATTRIBUTES
        if file not in self._tree.sizes:
            return {}
        with one_line(self.path, "a ReplayBuffer"):
            attributes = read_json(self._tree, file, self._limits)
            attributes = attributes.get("attributes", {}) if self._is_new else attributes
        if not isinstance(attributes, dict):
            raise StoreError(f"{self.path}: its attributes are no object")
        return attributes

    def _ours(self, ours: Any) -> Iterator[Recorded]:
        with one_line(self.path, "a ReplayBuffer of sheath-manip"):
            attributes = list(ours["episodes"])
            every = {LIMITED: list(ours["limits"]), SIGNALS: list(ours.get("signals", ()))}
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
            for path, names in ((LIMITED, header.limits), (SIGNALS, header.signals)):
                if names:
                    with one_line(self.path, f"the columns of {path} of every episode"):
                        columns = [every[path].index(name) for name in names]
                        arrays[path] = arrays[path][:, columns]
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

    def _array(self, group: str, key: str) -> ZarrArray:
        if f"{group}/{key}" not in self._arrays:
            raise StoreError(f"{self.path} has no array {group}/{key}")
        return self._arrays[f"{group}/{key}"]


def _array_paths(tree: PlainTree, is_new: bool) -> list[str]:
    """Where each array in `data` and `meta` is, both flat."""
    told = f"/{zarr3.NODE if is_new else zarr2.ARRAY}"
    paths = (file.removesuffix(told) for file in tree.sizes if file.endswith(told))
    return sorted(path for path in paths if path.count("/") == 1 and path.split("/")[0] in GROUPS)
