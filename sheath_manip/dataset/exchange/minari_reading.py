"""Reading Minari's data sets by h5py; `minari` says what ours hold.

Keys are the paths in an episode: `actions`, `rewards`, `observations` or, where these are
dictionaries, `observations/NAME/…`, and `infos/…`. Of what has T+1 rows the last is what followed
the last action.
"""

import json
import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import from_attributes
from sheath_manip.dataset.exchange.limits import Limits, stored_bytes
from sheath_manip.dataset.exchange.minari import ATTRIBUTE, DIGEST, METADATA, located
from sheath_manip.dataset.exchange.plain_tree import FolderTree, read_json
from sheath_manip.dataset.exchange.replay_buffer_writing import flat
from sheath_manip.dataset.exchange.sealing import require_digest
from sheath_manip.dataset.exchange.stored_images import decoded, is_jpeg
from sheath_manip.dataset.exchange.track import DefaultKeys, Ending, Track, one_line
from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.fields import MOST_STEPS, word
from sheath_manip.dataset.header import CAMERA, Header
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError

with needs("minari", "h5py"):
    import h5py

    from sheath_manip.dataset.exchange.hdf5 import (
        attribute,
        counted,
        dataset_bytes,
        datasets,
        is_blobs,
        member,
        open_file,
        read,
        read_blobs,
    )

WANTED = "a Minari data set"
MAIN = "main_data.hdf5"
SUCCESS = ("infos/success", "infos/is_success")
_ENDS = ("terminations", "truncations")


class MinariDataset:
    """A data set to import, ours or another's; raises StoreError where there is none."""

    def __init__(self, path: Path) -> None:
        """Look for it at `path`, which may be a name such as `D4RL/door/human-v2`."""
        self.path = located(path)
        self._limits = Limits(self.path, stored_bytes(self.path))
        with one_line(self.path, WANTED), self._limits.reading():
            tree = FolderTree(self.path)
            told = read_json(tree, METADATA, self._limits)
            if not isinstance(told, dict) or told.get("data_format", "hdf5") != "hdf5":
                kind = told.get("data_format") if isinstance(told, dict) else told
                raise StoreError(f"it is kept as {kind!r:.60}; wanted Minari's data_format 'hdf5'")
            if MAIN not in tree.sizes:
                raise StoreError(f"there is no {MAIN}")
            self._task = _task(told)
        with self._opened() as file:
            self._episodes = tuple(sorted(map(str, file), key=counted))
            group = self._group(file, self._episodes[0]) if self._episodes else None
            self._default_keys = {} if group is None else self._meant(group)

    @property
    def task(self) -> str | None:
        """The name of the environment, else of the data set."""
        return self._task

    @property
    def default_keys(self) -> DefaultKeys:
        """Observations that are images are cameras, by their names, and all others features."""
        return self._default_keys

    @property
    def is_sealed(self) -> bool:
        """Whether a digest tells what each episode is when it was written."""
        return self._all_have(DIGEST)

    def recorded(self) -> Iterator[Recorded] | None:
        """The episodes as they were exported, or None where another tool wrote the file."""
        self._limits.begin()
        return self._ours() if self._all_have(ATTRIBUTE) else None

    def tracks(self) -> Iterator[Track]:
        """Each episode by its own paths."""
        for number, episode in enumerate(self._episodes):
            with self._opened(episode) as file:
                group = self._group(file, episode)
                keys = self._keys(group)
                length = len(read(member(group, "rewards"), self._limits))
                if not 1 <= length <= MOST_STEPS:
                    raise StoreError(f"it has {length} rewards; wanted one a step")
                ends = [bool(read(member(group, name), self._limits)[-1]) for name in _ENDS]
            success = next((key for key in SUCCESS if key in keys), "")
            ending = Ending(None, ends[0], ends[1] or not ends[0])
            if success:
                ending = Ending.of(success, self._read(episode, success), *ends)
            yield Track(
                length=length,
                keys=keys,
                read=partial(self._before, episode, length),
                final=partial(self._after, episode, length),
                ending=ending,
                place=number,
            )

    def _before(self, episode: str, length: int, key: str) -> NDArray:
        values = self._read(episode, key)
        return values[:length] if len(values) == length + 1 else values

    def _after(self, episode: str, length: int, key: str) -> NDArray | None:
        values = self._read(episode, key)
        return values[length] if len(values) == length + 1 else None

    def _ours(self) -> Iterator[Recorded]:
        for episode in self._episodes:
            with self._opened(episode) as file:
                group = self._group(file, episode)
                self._keys(group)
                attributes: Any = json.loads(attribute(group, ATTRIBUTE))
                told = attribute(group, DIGEST) if DIGEST in group.attrs else None
            header = from_attributes(f"{episode} of {self.path}", attributes)
            recorded = Recorded(header, self._our_arrays(episode, header))
            require_digest(f"{episode} of {self.path}", recorded, told)
            yield recorded

    def _our_arrays(self, episode: str, header: Header) -> dict[str, Any]:
        arrays: dict[str, Any] = {}
        for spec in layout(header):
            path = spec.path.removeprefix("final/")
            # What has no element has no place there.
            if math.prod(spec.shape) == 0:
                arrays[spec.path] = np.zeros(spec.shape, spec.dtype)
            elif path == spec.path:
                arrays[path] = self._before(episode, header.length, _place(path))
            else:
                arrays[spec.path] = np.asarray(self._read_last(episode, path))
        return arrays

    def _read_last(self, episode: str, path: str) -> NDArray:
        with one_line(self.path, f"rows of {path} in {episode} of {WANTED}"):
            return self._read(episode, _place(path))[-1]

    def _meant(self, group: h5py.Group) -> DefaultKeys:
        keys = self._keys(group)
        observed = [key for key in keys if key.partition("/")[0] == "observations"]
        images = {key for key in observed if self._is_images(member(group, key))}
        features = tuple(key for key in observed if key not in images)
        meant = {"action": ("actions",), "reward": ("rewards",)}
        meant |= {"features": features} if features else {}
        for key in sorted(images):
            camera = key.partition("/")[2].replace("/", "_") or "image"
            if CAMERA.fullmatch(camera):
                meant[f"images/{camera}"] = (key,)
        return meant

    def _is_images(self, dataset: h5py.Dataset) -> bool:
        if is_blobs(dataset):
            return True
        shape = dataset.shape
        if dataset.dtype != np.uint8 or len(shape) not in (2, 4) or not shape[0]:
            return False
        # Images whose JPEGs happen to be of one length.
        return shape[-1] == 3 if len(shape) == 4 else is_jpeg(bytes(dataset[0]))

    def _all_have(self, name: str) -> bool:
        with self._opened() as file:
            have = [name in self._group(file, episode).attrs for episode in self._episodes]
        return bool(have) and all(have)

    def _keys(self, group: h5py.Group) -> tuple[str, ...]:
        """What holds numbers or images; they must fit into memory together."""
        sizes = {}
        for key, each in datasets(group, self._limits):
            if is_blobs(each):
                sizes[key] = each.shape[0]
            elif each.dtype.kind in "biuf" and each.shape:
                sizes[key] = dataset_bytes(each)
        self._limits.require_memory(str(group.name), sum(sizes.values()))
        return tuple(sorted(key for key in sizes if key not in _ENDS))

    def _read(self, episode: str, key: str) -> NDArray:
        with self._opened(episode) as file:
            dataset = member(self._group(file, episode), key)
            if not is_blobs(dataset):
                values = read(dataset, self._limits)
                if not self._is_images(dataset) or values.ndim != 2:
                    return values
                return decoded(key, [row.tobytes() for row in values], self._limits)
            return decoded(key, read_blobs(dataset, self._limits), self._limits)

    def _group(self, file: h5py.File, episode: str) -> Any:
        group = member(file, episode)
        if not isinstance(group, h5py.Group):
            raise StoreError(f"{episode} is no group")
        return group

    @contextmanager
    def _opened(self, episode: str = "") -> Iterator[h5py.File]:
        wanted = f"{episode} of {WANTED}" if episode else WANTED
        with (
            one_line(self.path, wanted),
            self._limits.reading(),
            open_file(self.path / MAIN) as file,
        ):
            yield file


def _place(path: str) -> str:
    """Return where an array of `layout` is in an episode of ours."""
    if path == "reward":
        return "rewards"
    observed = path.startswith(("images/", "features"))
    return f"observations/{flat(path)}" if observed else f"infos/{path}"


def _task(told: dict[str, Any]) -> str | None:
    spec = json.loads(told["env_spec"]) if isinstance(told.get("env_spec"), str) else None
    name = (spec.get("id") if isinstance(spec, dict) else None) or told.get("dataset_id")
    return word(name) if name else None
