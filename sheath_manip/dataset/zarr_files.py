"""The files of zarr's format 3, written without zarr, and the same to the byte.

zarr 3.1.6 hands each small write from thread to thread, which takes some 3.5 ms an array where the
work takes .2: most of the time that recording an episode would cost. Reading is left to zarr.
Format: https://zarr-specs.readthedocs.io/en/latest/v3/core/index.html
"""

import json
from collections.abc import Mapping
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from numcodecs.zstd import Zstd
from numpy.typing import NDArray

METADATA = "zarr.json"
_ZSTD_LEVEL = 1
"""A higher one, or a bit shuffle, only costs time."""


def write_group_file(directory: Path, attributes: Mapping[str, Any]) -> None:
    """Make `directory`, a group; raises OSError, and ValueError for NaN in `attributes`."""
    directory.mkdir()
    _write_metadata(directory, {"attributes": attributes, "zarr_format": 3, "node_type": "group"})


def write_array(directory: Path, values: NDArray, chunks: tuple[int, ...]) -> None:
    """Make `directory` and in it an array of `values`; raises OSError.

    Every chunk is written, also one of zeros, which would look the same as a lost one.
    """
    directory.mkdir()
    endian = {} if values.dtype.itemsize == 1 else {"configuration": {"endian": "little"}}
    _write_metadata(
        directory,
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
        (directory / key).write_bytes(zstd.encode(_chunk(little, chunks, place)))


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


def _write_metadata(directory: Path, metadata: Mapping[str, Any]) -> None:
    (directory / METADATA).write_text(json.dumps(metadata, indent=2, allow_nan=False))
