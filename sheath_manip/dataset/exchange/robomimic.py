"""robomimic's HDF5: one group an episode, observations by key, and the next ones beside them.

| path in `data/demo_i` | meaning |
|---|---|
| `actions` | (T, a) float32, the action that was chosen for export |
| `obs/CAMERA_image`, `obs/features` | (T, ...) before the action |
| `next_obs/...` | (T, ...) after it; the last row is the final observation |
| `rewards`, `states` | (T,), (T, s) |
| `dones` | (T,) int64, 1 at the last step |
| `terminated`, `truncated` | (T,) bool, whether and how the episode ended there |
| `NAME` | every other array of `layout`, by its name there |
| `final_state`, `final_time_s` | after the last action |

`mask/success` lists the episodes that succeeded. The attribute `sheath` of each holds its header,
`sheath_digest` a digest of header and arrays.
"""

import json
from collections.abc import Iterable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import from_attributes, to_attributes
from sheath_manip.dataset.exchange.formats import Format
from sheath_manip.dataset.exchange.limits import Limits, stored_bytes
from sheath_manip.dataset.exchange.sealing import digest_of, require_digest
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.track import DefaultKeys, Track, one_line
from sheath_manip.dataset.exchange.uniform import compatible
from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.fields import MOST_STEPS
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Outcome

with needs("robomimic", "h5py"):
    import h5py

    from sheath_manip.dataset.exchange.hdf5 import (
        attribute,
        dataset_bytes,
        datasets,
        member,
        open_file,
        read,
    )
    from sheath_manip.dataset.exchange.hdf5_sink import Hdf5Sink

ATTRIBUTE, DIGEST = "sheath", "sheath_digest"
WANTED = "a robomimic HDF5 file"
_RENAMED = {"features": "obs/features", "reward": "rewards", "state": "states"}
_FRAMES_PER_CHUNK = 8
"""robomimic reads short sequences at random, or the whole into RAM."""


def write(target: Path, episodes: Iterable[Recorded], action: ActionChoice) -> None:
    """Write `episodes` into the HDF5 file `target`."""
    sink = Hdf5Sink(target)
    with closing(sink), h5py.File(sink, "w") as file:
        data, steps, successes = file.create_group("data"), 0, []
        for number, recorded in enumerate(compatible(episodes)):
            header = recorded.header
            demo = data.create_group(f"demo_{number}")
            _write_arrays(demo, recorded)
            _write(demo, "actions", recorded.arrays[action])
            last = np.arange(header.length) == header.length - 1
            _write(demo, "dones", last.astype(np.int64))
            _write(demo, "terminated", last & header.terminated)
            _write(demo, "truncated", last & header.truncated)
            demo.attrs["num_samples"] = header.length
            demo.attrs[ATTRIBUTE] = json.dumps(to_attributes(header))
            demo.attrs[DIGEST] = digest_of(recorded)
            sink.require_written()
            steps += header.length
            if header.outcome is Outcome.SUCCESS:
                successes.append(f"demo_{number}".encode())
            if number == 0:
                # robomimic makes an environment of it only for rollouts, which this one has not.
                environment = {"env_name": header.info.task, "type": None, "env_kwargs": {}}
                data.attrs["env_args"] = json.dumps(environment)
        data.attrs["total"] = steps
        file.create_dataset("mask/success", data=np.array(successes, dtype="S16"))
    sink.require_written()


def place(path: str) -> str:
    """Return where an array of `layout` with a row for each step is in an episode's group."""
    if path.startswith("images/"):
        return f"obs/{path.removeprefix('images/')}_image"
    return _RENAMED.get(path, path)


def _write_arrays(demo: h5py.Group, recorded: Recorded) -> None:
    arrays = recorded.arrays
    for spec in layout(recorded.header):
        if spec.path.startswith("final/"):
            at = place(spec.path.removeprefix("final/"))
            if not at.startswith("obs/"):
                demo.create_dataset(_final(spec.path), data=arrays[spec.path])
            continue
        at = place(spec.path)
        _write(demo, at, arrays[spec.path])
        if at.startswith("obs/"):
            final = arrays[f"final/{spec.path}"][None]
            _write(demo, f"next_{at}", np.concatenate([arrays[spec.path][1:], final]))


def _final(path: str) -> str:
    return path.replace("/", "_")


def _write(demo: h5py.Group, name: str, values: NDArray) -> None:
    if not values.size:
        demo.create_dataset(name, data=values)
        return
    chunks = (min(_FRAMES_PER_CHUNK if values.ndim == 4 else 1024, len(values)), *values.shape[1:])
    # Any HDF5 has gzip; the fastest level, since images are most of it.
    demo.create_dataset(name, data=values, chunks=chunks, compression="gzip", compression_opts=1)


class RobomimicFile:
    """An HDF5 file of robomimic's to import, ours or another's; raises StoreError if it is none."""

    default_keys: ClassVar[DefaultKeys] = {
        "action": ("actions",),
        "reward": ("rewards",),
        "state": ("states",),
    }

    def __init__(self, path: Path) -> None:
        self.path = path
        self._limits = Limits(path, stored_bytes(path))
        with self._opened() as file:
            data = member(file, "data")
            self._demos = sorted(data, key=_number)
            self._said_hz = _said_hz(data)

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
                length = attribute(group, "num_samples")
                if isinstance(length, float | np.floating) and length == int(length):
                    length = int(length)
                if not isinstance(length, int | np.integer) or not 1 <= length <= MOST_STEPS:
                    raise StoreError(f"num_samples is {length!r:.60}; wanted a number of steps")
            yield Track(
                length=int(length),
                keys=keys,
                read=lambda key, demo=demo: self._read(demo, key),
                final=lambda key, demo=demo, keys=keys: (
                    self._read(demo, f"next_{key}")[-1] if f"next_{key}" in keys else None
                ),
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
                    arrays[spec.path] = self._read(demo, _final(spec.path))
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


def _said_hz(data: h5py.Group) -> float | None:
    if "env_args" not in data.attrs:
        return None
    told = json.loads(attribute(data, "env_args"))
    rate_hz = (told.get("env_kwargs") or {}).get("control_freq")
    return None if rate_hz is None else float(rate_hz)


def _number(demo: str) -> tuple[int, str]:
    """robomimic counts demo_0, demo_1, …; anything else comes after."""
    digits = demo.rpartition("_")[2]
    return (int(digits) if digits.isdecimal() and len(digits) < 10 else 10**9, demo)


FORMAT = Format(write, RobomimicFile)
