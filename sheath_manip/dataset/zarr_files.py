"""The files of zarr's format 3, made without zarr, and the same to the byte.

zarr 3.1.6 hands each small write from thread to thread, which takes some 3.5 ms an array where the
work takes .2: most of the time that recording an episode would cost. Reading is left to zarr.
Format: https://zarr-specs.readthedocs.io/en/latest/v3/core/index.html
"""

import json
from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
from numcodecs.zstd import Zstd
from numpy.typing import NDArray

from sheath_manip.dataset.durable import Files

METADATA = "zarr.json"
_ZSTD_LEVEL = 1
"""A higher one, or a bit shuffle, only costs time."""


def group_files(attributes: Mapping[str, Any]) -> dict[str, bytes]:
    """A group, without what is in it; raises ValueError for NaN in `attributes`."""
    return _metadata({"attributes": attributes, "zarr_format": 3, "node_type": "group"})


def array_files(values: NDArray, chunks: tuple[int, ...]) -> dict[str, bytes]:
    """An array of `values`.

    Every chunk is written, also one of zeros, which would look the same as a lost one.
    """
    endian = {} if values.dtype.itemsize == 1 else {"configuration": {"endian": "little"}}
    files = _metadata(
        {
            "shape": values.shape,
            "data_type": values.dtype.name,
            "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": chunks}},
            # One directory an array instead of one a dimension: there is less to sync.
            "chunk_key_encoding": {"name": "default", "configuration": {"separator": "."}},
            "fill_value": values.dtype.type(0).item(),
            "codecs": [
                {"name": "bytes", **endian},
                # The checksum finds a changed byte.
                {"name": "zstd", "configuration": {"level": _ZSTD_LEVEL, "checksum": True}},
            ],
            "attributes": {},
            "zarr_format": 3,
            "node_type": "array",
            "storage_transformers": [],
        },
    )
    little = values.astype(values.dtype.newbyteorder("<"), copy=False)
    zstd = Zstd(level=_ZSTD_LEVEL, checksum=True)
    counts = (-(-size // chunk) for size, chunk in zip(values.shape, chunks, strict=True))
    for place in product(*map(range, counts)):
        key = ".".join(map(str, ("c", *place)))
        files[key] = zstd.encode(_chunk(little, chunks, place))
    return files


def within(folder: str, files: Files) -> dict[str, bytes]:
    """Return the same files, in a `folder`."""
    return {f"{folder}/{path}": content for path, content in files.items()}


def _chunk(values: NDArray, chunks: tuple[int, ...], place: tuple[int, ...]) -> NDArray:
    """The chunk at `place` of the grid, filled up with zeros where it reaches over the edge."""
    inside = values[
        tuple(slice(i * size, (i + 1) * size) for i, size in zip(place, chunks, strict=True))
    ]
    if inside.shape == chunks:
        return np.ascontiguousarray(inside)
    whole = np.zeros(chunks, values.dtype)
    whole[tuple(map(slice, inside.shape))] = inside
    return whole


def _metadata(metadata: Mapping[str, Any]) -> dict[str, bytes]:
    # Python's encoder is ten times as fast without indentation.
    return {METADATA: json.dumps(metadata, allow_nan=False).encode()}
