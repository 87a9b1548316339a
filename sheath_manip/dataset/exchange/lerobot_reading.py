"""Reading LeRobot's data sets by pyarrow and PyAV; `lerobot` says what ours hold."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import from_attributes
from sheath_manip.dataset.exchange.film import frames
from sheath_manip.dataset.exchange.lerobot import HEADERS, feature_name
from sheath_manip.dataset.exchange.lerobot_index import (
    KEPT_TO_ITSELF,
    Entry,
    Feature,
    read_index,
)
from sheath_manip.dataset.exchange.limits import FILM_TIMES_LARGER, Limits, stored_bytes
from sheath_manip.dataset.exchange.parquet import MOST_ITEM_BYTES, Parquet
from sheath_manip.dataset.exchange.plain_tree import FolderTree, read_json
from sheath_manip.dataset.exchange.stored_images import decoded
from sheath_manip.dataset.exchange.track import DefaultKeys, Ending, Track, one_line
from sheath_manip.dataset.header import CAMERA, Header
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError

WANTED = "a LeRobot data set"
SUCCESS = "next.success"
STATES = ("observation.state", "observation.environment_state")
INTERVENTIONS = ("intervention", "complementary_info.is_intervention")
"""by what name data sets tell that a person acted: LeRobot's own recorders, and others'"""


class LeRobotDirectory:
    """A data set to import, ours or another's; raises StoreError where `path` is none."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._limits = Limits(path, stored_bytes(path), FILM_TIMES_LARGER)
        with self._reading(WANTED):
            if not path.is_dir():
                raise StoreError("it is no directory")
            self._tree = FolderTree(path)
            self._index = read_index(self._tree, self._limits)
        self._features = {
            name: feature
            for name, feature in self._index.features.items()
            if name not in KEPT_TO_ITSELF and feature.dtype != "string"
        }
        self._tables: dict[str, Parquet] = {}

    @property
    def control_rate_hz(self) -> float:
        """Frames a second."""
        return self._index.rate_hz

    @property
    def task(self) -> str | None:
        """The words that all episodes have in common; None where they have several, or none."""
        words = {entry.words for entry in self._index.entries}
        return words.pop() or None if len(words) == 1 else None

    @property
    def default_keys(self) -> DefaultKeys:
        """States are features; cameras have their names, without `observation.images`."""
        keys = {"action": ("action",), "reward": ("next.reward",)}
        states = tuple(name for name in STATES if name in self._features)
        flags = tuple(name for name in INTERVENTIONS if name in self._features)[:1]
        keys |= {"features": states} if states else {}
        keys |= {"intervention": flags} if flags else {}
        for name, feature in self._features.items():
            camera = name.removeprefix("observation.").removeprefix("images.")
            if feature.is_image and CAMERA.fullmatch(camera):
                keys[f"images/{camera}"] = (name,)
        return keys

    def recorded(self) -> Iterator[Recorded] | None:
        """The episodes as they were exported, or None where another tool wrote the files."""
        self._limits.begin()
        return self._ours() if HEADERS in self._tree.sizes else None

    def tracks(self) -> Iterator[Track]:
        """Each episode by its features, a number of a named vector also as `FEATURE/NAME`."""
        parts = [
            f"{key}/{name}" for key, feature in self._features.items() for name in feature.names
        ]
        for entry in self._index.entries:
            self._require_rows(entry)
            yield Track(
                length=entry.length,
                keys=(*self._features, *parts),
                read=partial(self._read_key, entry),
                final=lambda _: None,
                ending=self._ending(entry),
                words=entry.words,
            )

    def _ending(self, entry: Entry) -> Ending:
        if SUCCESS not in self._features:
            return Ending()
        success = self._read(entry, SUCCESS)
        # Data sets end where their task is done, and otherwise where somebody lost patience.
        return Ending.of(SUCCESS, success, bool(success.any()), False)

    def _ours(self) -> Iterator[Recorded]:
        with self._reading(WANTED):
            told = read_json(self._tree, HEADERS, self._limits)
            if not isinstance(told, list) or len(told) != len(self._index.entries):
                raise StoreError(f"{HEADERS} has other episodes than the index")
        for entry, attributes in zip(self._index.entries, told, strict=True):
            self._require_rows(entry)
            if isinstance(attributes, dict):
                # By how much each limit changed the command is not kept, only the largest; what a
                # score was made of is not kept.
                attributes |= {"limits": [], "signals": []}
            header = from_attributes(f"episode {entry.number} of {self.path}", attributes)
            if header.length != entry.length:
                raise StoreError(f"{HEADERS} and the index tell of other lengths")
            yield Recorded(header, self._our_arrays(entry, header))

    def _our_arrays(self, entry: Entry, header: Header) -> dict[str, Any]:
        """The observation after the last action is lost: the last one stands in."""
        arrays: dict[str, Any] = {}
        for spec in layout(header):
            name, before = feature_name(spec.path), spec.path.removeprefix("final/")
            if before != spec.path:
                arrays[spec.path] = np.asarray(arrays[before][-1])
            elif math.prod(spec.shape) == 0:
                arrays[spec.path] = np.zeros(spec.shape, spec.dtype)
            else:
                values = self._read(entry, name)
                if values.dtype != spec.dtype or values.size != math.prod(spec.shape):
                    raise StoreError(f"{name} is {values.dtype} {values.shape}; wanted {spec}")
                arrays[spec.path] = values.reshape(spec.shape)
        arrays["final/time_s"] = arrays["final/time_s"] + 1 / header.info.control_rate_hz
        return arrays

    def _require_rows(self, entry: Entry) -> None:
        """Raise StoreError where the table's rows are another episode's, or ask for too much."""
        row_bytes = sum(
            math.prod(feature.shape) * (3 if feature.is_image else MOST_ITEM_BYTES)
            for feature in self._features.values()
        )
        self._limits.require_memory(f"episode {entry.number}", entry.length * row_bytes)
        for name, wanted in (
            ("episode_index", np.full(entry.length, entry.number)),
            ("frame_index", np.arange(entry.length)),
        ):
            found = self._rows(entry, name, Feature("int64", (1,)))
            if not np.array_equal(found[:, 0], wanted):
                raise StoreError(
                    f"{entry.table} of {self.path}: {name} of rows {entry.first_row} … is not that "
                    f"of the {entry.length} frames of episode {entry.number}"
                )

    def _read_key(self, entry: Entry, key: str) -> NDArray:
        if key in self._features:
            return self._read(entry, key)
        whole, _, name = key.rpartition("/")
        place = self._features[whole].names.index(name)
        return self._read(entry, whole)[:, place]

    def _read(self, entry: Entry, key: str) -> NDArray:
        feature = self._features.get(key)
        if feature is None:
            raise StoreError(f"{self.path} has no feature {key!r}")
        if feature.dtype != "video":
            return self._rows(entry, key, feature)
        clip = entry.clips[key]
        rate_hz = self._index.rate_hz
        with self._reading(f"frames of {clip.file}"), self._tree.open(clip.file) as file:
            height, width = feature.shape
            first, shape = round(clip.from_s * rate_hz), (entry.length, height, width)
            return frames(clip.file, file, first, shape, rate_hz, self._limits)

    def _rows(self, entry: Entry, key: str, feature: Feature) -> NDArray:
        start, stop = entry.first_row, entry.first_row + entry.length
        with self._reading(f"{key} of {entry.table}"):
            table = self._table(entry.table)
            if not feature.is_image:
                return table.numbers(key, start, stop, feature.shape)
            encoded = [self._content(row) for row in table.rows(key, start, stop)]
            images = decoded(key, encoded, self._limits)
            if images.shape != (entry.length, *feature.shape, 3):
                raise StoreError(f"its images are {images.shape}; wanted {feature.shape} pixels")
            return images

    def _content(self, row: Any) -> bytes:
        """An image as it was encoded: in the table, or in a file of this directory."""
        if isinstance(row, bytes):
            return row
        if isinstance(row, dict) and isinstance(row.get("bytes"), bytes):
            return row["bytes"]
        file = row.get("path") if isinstance(row, dict) else None
        if not isinstance(file, str) or file not in self._tree.sizes:
            raise StoreError(f"an image is in {file!r:.100}, and that is no file of {self.path}")
        return self._tree.read(file)

    def _table(self, file: str) -> Parquet:
        if file not in self._tables:
            # One is open at a time: format 2 has thousands.
            self._tables.clear()
            self._tables[file] = Parquet(self._tree, file, self._limits)
        return self._tables[file]

    @contextmanager
    def _reading(self, wanted: str) -> Iterator[None]:
        with one_line(self.path, wanted), self._limits.reading():
            yield
