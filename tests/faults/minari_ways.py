"""Ways to spoil a Minari data set and a ReplayBuffer of zarr's format 3; each is seeded."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from tests.faults.exchange_ways import SECRET, Rng, Spoil, links_among, one_of

TEXTS = ("[" * 10**5, "null", "[]", "7", "", '{"data_format": "arrow"}', '{"env_spec": "["}')
NAMES = ("actions", "rewards", "observations/camera", "observations/pos", "infos/success")


def objects(path: Path, rng: Rng) -> None:
    """Data that are elsewhere, are no numbers, or ask for memory that nobody has."""
    with h5py.File(path / "data" / "main_data.hdf5", "r+") as file:
        group: Any = file["episode_0"]
        name = one_of(rng, [name for name in NAMES if name in group] or ["rewards"])
        secret = path.parent / SECRET
        del group[name]
        kind = int(rng.integers(9))
        if kind == 0:
            group[name] = h5py.ExternalLink(str(path.parent / "other.hdf5"), "/x")
        elif kind == 1:
            group[name] = h5py.SoftLink("/episode_1/actions")
        elif kind == 2:
            group.create_dataset(name, (4, 3), "f4", external=[(str(secret), 0, 10**4)])
        elif kind == 3:
            group.create_dataset(name, (10**12, 3), "f4", chunks=True)
        elif kind == 4:
            group[name] = np.array(["a", "b"], dtype=h5py.string_dtype())
        elif kind == 5:
            blobs = group.create_dataset(name, (5,), dtype=h5py.vlen_dtype(np.uint8))
            blobs[0] = np.frombuffer(b"\xff\xd8\xff" + rng.bytes(50), np.uint8)
        elif kind == 6:
            group.create_dataset(name, (5,), dtype=h5py.vlen_dtype(np.float32))
        elif kind == 7:
            group[name] = np.zeros((2, 2), np.float32)
        else:
            group[name] = 7.0


def metadata(path: Path, rng: Rng) -> None:
    (path / "data" / "metadata.json").write_text(one_of(rng, TEXTS))


def array_of_3(path: Path, rng: Rng) -> None:
    """What zarr's format 3 says of an array is not what is read here."""
    file = one_of(rng, sorted(path.glob("*/*/zarr.json")))
    told = json.loads(file.read_text())
    key = one_of(rng, list(METADATA_3))
    told[key] = one_of(rng, METADATA_3[key])
    file.write_text(json.dumps(told))


def group_of_3(path: Path, rng: Rng) -> None:
    texts = ("[" * 10**5, "null", "[]", "", '{"zarr_format": 2}', '{"node_type": "group"}')
    (path / "zarr.json").write_text(one_of(rng, texts))


_BYTES = {"name": "bytes", "configuration": {"endian": "little"}}
METADATA_3: Mapping[str, tuple[Any, ...]] = {
    "data_type": ("string", "complex64", "r16", {"name": "x"}, 7, None, "float64", "int8"),
    "shape": ([10**15, 10**15], [-1], [], ["x"], [True], None, [10**400], [10**9, 2]),
    "chunk_grid": ({}, None, {"name": "regular", "configuration": {"chunk_shape": [0]}}, [7]),
    "chunk_key_encoding": ({}, None, {"name": "x"}, {"name": "v2"}, {"name": ["default"]}),
    "codecs": (
        [],
        None,
        [7],
        [{"name": "sharding_indexed", "configuration": {"chunk_shape": [1]}}],
        [_BYTES, {"name": "numcodecs.pickle"}],
        [_BYTES, {"name": "zstd"}, {"name": "zstd"}],
        [_BYTES, {"name": "crc32c"}],
        [{"name": "transpose"}, _BYTES],
        [{"name": ["bytes"]}],
    ),
    "fill_value": ("moon", {"a": 1}, [7], 10**400),
    "node_type": ("group", None),
    "zarr_format": (2, None),
    "storage_transformers": ([{"name": "x"}],),
}
MINARI: Mapping[str, Spoil] = {
    "data that are elsewhere or no numbers": objects,
    "what it says of itself": metadata,
    "links and pipes": links_among("**/*.hdf5", "**/*.json"),
}
ZARR_3: Mapping[str, Spoil] = {
    "metadata of an array (zarr 3)": array_of_3,
    "metadata of a group (zarr 3)": group_of_3,
}
