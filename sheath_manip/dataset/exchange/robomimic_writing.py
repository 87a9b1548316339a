"""Writing robomimic's HDF5; `robomimic` says what is where."""

import json
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.exchange.actions import REQUESTED, chosen, requested
from sheath_manip.dataset.exchange.sealing import digest_of
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.exchange.uniform import compatible
from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.types import Outcome

with needs("robomimic", "h5py"):
    import h5py

    from sheath_manip.dataset.exchange.hdf5_sink import Hdf5Sink

ATTRIBUTE, DIGEST = "sheath", "sheath_digest"
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
            _write(demo, "actions", chosen(recorded, action))
            _write(demo, REQUESTED, requested(recorded))
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
                told = {"control_freq": header.info.control_rate_hz}
                environment = {"env_name": header.info.task, "type": None, "env_kwargs": told}
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
                demo.create_dataset(final_place(spec.path), data=arrays[spec.path])
            continue
        at = place(spec.path)
        _write(demo, at, arrays[spec.path])
        if at.startswith("obs/"):
            final = arrays[f"final/{spec.path}"][None]
            _write(demo, f"next_{at}", np.concatenate([arrays[spec.path][1:], final]))


def final_place(path: str) -> str:
    """Return where what follows the last action is, where it is no observation."""
    return path.replace("/", "_")


def _write(demo: h5py.Group, name: str, values: NDArray) -> None:
    if not values.size:
        demo.create_dataset(name, data=values)
        return
    chunks = (min(_FRAMES_PER_CHUNK if values.ndim == 4 else 1024, len(values)), *values.shape[1:])
    # Any HDF5 has gzip; the fastest level, since images are most of it.
    demo.create_dataset(name, data=values, chunks=chunks, compression="gzip", compression_opts=1)
