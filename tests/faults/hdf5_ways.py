"""Ways to spoil an HDF5 file, and to make it pull in what lies elsewhere; each is seeded."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tests.faults.exchange_ways import SECRET, Rng, Spoil, one_of

NUMBERS = ("actions", "rewards", "obs/pos", "obs/features")


def hdf5_objects(path: Path, rng: Rng) -> None:
    """Data that are elsewhere, are no numbers, or ask for memory that nobody has."""
    with h5py.File(path, "r+") as file:
        demo: Any = file["data/demo_0"]
        name, another = rng.permutation([n for n in NUMBERS if n in demo])[:2]
        old = demo[name][()]
        del demo[name]
        kind = one_of(rng, range(14))
        secret = path.parent / SECRET
        if kind == 0:
            demo[name] = h5py.ExternalLink(str(path.parent / "other.hdf5"), "/x")
        elif kind == 1:
            demo[name] = h5py.SoftLink("/data/demo_1/actions")
        elif kind == 2:
            demo.create_dataset(name, old.shape, old.dtype, external=[(str(secret), 0, 10**4)])
        elif kind == 3:
            layout = h5py.VirtualLayout(old.shape, old.dtype)
            layout[:] = h5py.VirtualSource(path.parent / "other.hdf5", "x", old.shape)
            demo.create_virtual_dataset(name, layout)
        elif kind == 4:
            demo["obs/loop"] = demo["obs"]
        elif kind == 5:
            demo[name] = demo[another]
        elif kind == 6:
            demo.create_dataset(name, (10**12, *old.shape[1:]), old.dtype, chunks=True)
        elif kind == 7:
            shape = (2**29, 3)
            demo.create_dataset(name, (4, 3), "f8", chunks=shape, maxshape=(None, 3))
        elif kind == 8:
            demo[name] = np.array(["a", "b"], dtype=h5py.string_dtype())
        elif kind == 9:
            demo.create_dataset(name, (4,), dtype=h5py.vlen_dtype(np.float32))
        elif kind == 10:
            demo.create_dataset(name, data=np.zeros(4, [("a", "f4"), ("b", "i8")]))
        elif kind == 11:
            demo.create_dataset(name, (4,), dtype=h5py.ref_dtype)
        elif kind == 12:
            demo.create_dataset(name, data=old.astype(np.longdouble))
        else:
            demo[name] = old[:2]


def hdf5_attributes(path: Path, rng: Rng) -> None:
    with h5py.File(path, "r+") as file:
        data: Any = file["data"]
        demo = one_of(rng, [data["demo_0"], data["demo_1"]])
        wrong = [0, -1, 10**18, 3.5, np.nan, "x", np.arange(4), np.array([True]), None, b"\xff"]
        name = one_of(rng, ["num_samples", "num_samples", "env_args", "sheath"])
        where = data if name == "env_args" else demo
        value = one_of(rng, wrong)
        if name == "env_args":
            texts = ["{", "7", "[]", "[" * 10**4, '{"env_kwargs": 7}']
            rates = ("1e999", "[]", '"x"', "NaN")
            texts += [f'{{"env_kwargs": {{"control_freq": {rate}}}}}' for rate in rates]
            value = one_of(rng, texts)
        if value is None:
            where.attrs.pop(name, None)
        else:
            where.attrs[name] = value


def hdf5_shape(path: Path, rng: Rng) -> None:
    """The tree is another one."""
    with h5py.File(path, "r+") as file:
        kind = int(rng.integers(5))
        if kind == 0:
            del file["data"]
        elif kind == 1:
            file["data/demo_9"] = h5py.SoftLink("/data/demo_0")
        elif kind == 2:
            file["data/demo_\u00b2\x1b[2J"] = np.zeros(3)
        elif kind == 3:
            file["data/demo_3"] = file["data"]
        else:
            group: Any = file["data/demo_0"]
            for depth in range(50):
                group = group.create_group(f"d{depth}")
            group["x"] = 1.0


HDF5: Mapping[str, Spoil] = {
    "data that are elsewhere or no numbers": hdf5_objects,
    "attributes": hdf5_attributes,
    "another tree": hdf5_shape,
}
