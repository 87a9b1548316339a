"""Reading robomimic's HDF5, and robosuite's raw `demo.hdf5`; `robomimic` says what ours hold.

The raw file holds what a person did and no observation: states and actions, the environment's name,
and the model of each demonstration as XML, which is not taken. How many steps there are only its
actions say.
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from copy import copy
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import from_attributes
from sheath_manip.dataset.exchange.limits import Limits, stored_bytes
from sheath_manip.dataset.exchange.robomimic_writing import (
    ATTRIBUTE,
    DIGEST,
    final_place,
    place,
)
from sheath_manip.dataset.exchange.sealing import require_digest
from sheath_manip.dataset.exchange.track import DefaultKeys, Track, one_line
from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.fields import MOST_STEPS, word
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError

with needs("robomimic", "h5py"):
    import h5py

    from sheath_manip.dataset.exchange.hdf5 import (
        attribute,
        counted,
        dataset_bytes,
        datasets,
        member,
        open_file,
        read,
        read_names,
    )

WANTED = "a robomimic HDF5 file"


class RobomimicFile:
    """An HDF5 file of robomimic's to import, ours or another's; raises StoreError if it is none."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._limits = Limits(path, stored_bytes(path))
        with self._opened() as file:
            data = member(file, "data")
            self._all = tuple(sorted(map(str, data), key=counted))
            told = _environment(data)
            self._said_hz, self._task = _rate_hz(told), _name(told)
            self._is_raw = bool(self._all) and "obs" not in member(data, self._all[0])
            self.masks = tuple(sorted(map(str, member(file, "mask")))) if "mask" in file else ()
        self._demos = self._all

    @property
    def default_keys(self) -> DefaultKeys:
        """Of a raw file the states are the features, too: it has nothing else."""
        keys = {"action": ("actions",), "reward": ("rewards",), "state": ("states",)}
        return {**keys, "features": ("states",)} if self._is_raw else keys

    @property
    def task(self) -> str | None:
        """The name of the environment; None where none is told."""
        return self._task

    def only(self, mask: str) -> Self:
        """Return the file with the demonstrations that a list below `mask/` names."""
        with self._opened() as file:
            names = set(read_names(member(file, f"mask/{mask}"), self._limits))
        if unknown := sorted(names - set(self._all)):
            raise StoreError(f"{self.path}: mask/{mask} names {unknown[0]!r}, and it is not there")
        some = copy(self)
        some._demos = tuple(demo for demo in self._all if demo in names)
        return some

    @property
    def control_rate_hz(self) -> float | None:
        """What the environment was made with, as robosuite's are; None where none is told."""
        return self._said_hz

    @property
    def is_sealed(self) -> bool:
        """Whether a digest tells what each episode was when it was written."""
        return self._all_have(DIGEST)

    def recorded(self) -> Iterator[Recorded] | None:
        """The episodes as they were exported, or None where another tool wrote the file."""
        self._limits.begin()
        return self._ours() if self._all_have(ATTRIBUTE) else None

    def tracks(self) -> Iterator[Track]:
        """Each episode by the file's own keys, those of observations as `obs/NAME`."""
        for demo in self._demos:
            with self._opened(demo) as file:
                group = self._demo(file, demo)
                keys = self._keys(group)
                length = _length(group)
                beside = ("model_file",) if "model_file" in group.attrs else ()
            yield Track(
                length=length,
                keys=keys,
                read=lambda key, demo=demo: self._read(demo, key),
                final=lambda key, demo=demo, keys=keys: (
                    self._read(demo, f"next_{key}")[-1] if f"next_{key}" in keys else None
                ),
                place=self._all.index(demo),
                beside=beside,
            )

    def _ours(self) -> Iterator[Recorded]:
        for demo in self._demos:
            with self._opened(demo) as file:
                group = self._demo(file, demo)
                self._keys(group)
                attributes: Any = json.loads(attribute(group, ATTRIBUTE))
                told = attribute(group, DIGEST) if DIGEST in group.attrs else None
            header = from_attributes(f"{demo} of {self.path}", attributes)
            arrays = {}
            for spec in layout(header):
                path = spec.path.removeprefix("final/")
                at = place(path)
                if path == spec.path:
                    arrays[path] = self._read(demo, at)
                elif at.startswith("obs/"):
                    arrays[spec.path] = self._read_last(demo, f"next_{at}")
                else:
                    arrays[spec.path] = self._read(demo, final_place(spec.path))
            recorded = Recorded(header, arrays)
            require_digest(f"{demo} of {self.path}", recorded, told)
            yield recorded

    def _all_have(self, name: str) -> bool:
        with self._opened() as file:
            have = [name in self._demo(file, demo).attrs for demo in self._demos]
        return bool(have) and all(have)

    def _keys(self, group: h5py.Group) -> tuple[str, ...]:
        """The arrays of an episode, which must fit into memory together."""
        sizes = {key: dataset_bytes(each) for key, each in datasets(group, self._limits)}
        self._limits.require_memory(str(group.name), sum(sizes.values()))
        return tuple(sorted(key for key in sizes if member(group, key).shape))

    def _read(self, demo: str, key: str) -> NDArray:
        with self._opened(demo) as file:
            return read(member(self._demo(file, demo), key), self._limits)

    def _read_last(self, demo: str, key: str) -> NDArray:
        with one_line(self.path, f"rows of {key} in {demo} of {WANTED}"):
            return self._read(demo, key)[-1]

    def _demo(self, file: h5py.File, demo: str) -> Any:
        """The group of an episode."""
        group = member(member(file, "data"), demo)
        if not isinstance(group, h5py.Group):
            raise StoreError(f"{demo} is no group")
        return group

    @contextmanager
    def _opened(self, demo: str = "") -> Iterator[h5py.File]:
        wanted = f"{demo} of {WANTED}" if demo else WANTED
        with (
            one_line(self.path, wanted),
            self._limits.reading(),
            open_file(self.path) as file,
        ):
            yield file


def _length(group: h5py.Group) -> int:
    """Return the number of steps: what the file says, or that of the actions."""
    if "num_samples" in group.attrs:
        length = attribute(group, "num_samples")
    else:
        length = (*getattr(member(group, "actions"), "shape", ()), 0)[0]
    if isinstance(length, float | np.floating) and length == int(length):
        length = int(length)
    if not isinstance(length, int | np.integer) or not 1 <= length <= MOST_STEPS:
        raise StoreError(f"num_samples is {length!r:.60}; wanted a number of steps")
    return int(length)


def _environment(data: h5py.Group) -> dict[str, Any]:
    """Return what a file says of its environment, robomimic's in `env_args`, robosuite's raw."""
    if "env_args" in data.attrs:
        return _object(data, "env_args")
    told = {"env_kwargs": _object(data, "env_info")} if "env_info" in data.attrs else {}
    return {**told, "env_name": attribute(data, "env")} if "env" in data.attrs else told


def _object(data: h5py.Group, name: str) -> dict[str, Any]:
    told = json.loads(attribute(data, name))
    if not isinstance(told, dict):
        raise StoreError(f"{name} is {told!r:.60}; wanted an object")
    return told


def _rate_hz(environment: dict[str, Any]) -> float | None:
    rate_hz = (environment.get("env_kwargs") or {}).get("control_freq")
    return None if rate_hz is None else float(rate_hz)


def _name(environment: dict[str, Any]) -> str | None:
    name = environment.get("env_name")
    return word(name) if name else None
