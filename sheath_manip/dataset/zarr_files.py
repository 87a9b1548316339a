"""The files of zarr's format 3, made and read without zarr, and the same to the byte.

zarr 3.1.6 hands each small read and write from thread to thread, which takes some 3.5 ms an array
where the work takes .2: most of the time that recording an episode would cost. It also decodes
whatever codec and type a file asks for, and follows links.
Format: https://zarr-specs.readthedocs.io/en/latest/v3/core/index.html
"""

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from itertools import product
from typing import Any

import numpy as np
from numcodecs.zstd import Zstd
from numpy.typing import NDArray

from sheath_manip.dataset.zstd_frame import zstd_told_bytes

METADATA = "zarr.json"
_ZSTD_LEVEL = 1
"""A higher one, or a bit shuffle, only costs time."""
DTYPES = ("bool", "uint8", "int64", "float32", "float64")
"""the types that are written and read; there is no code in any of them"""

File = tuple[str, bytes]
"""a path in a folder, with slashes, and what is there"""


def group_file(attributes: Mapping[str, Any]) -> bytes:
    """The metadata of a group; raises ValueError for NaN in `attributes`."""
    return _encoded({"attributes": attributes, "zarr_format": 3, "node_type": "group"})


def array_metadata(shape: tuple[int, ...], dtype: str, chunks: tuple[int, ...]) -> dict[str, Any]:
    """The metadata of an array, as JSON; raises ValueError where `dtype` is none of `DTYPES`.

    All that may be decoded is what has exactly these.
    """
    if dtype not in DTYPES:
        raise ValueError(f"wanted one of the types {', '.join(DTYPES)}, found {dtype}")
    kind = np.dtype(dtype)
    endian = {} if kind.itemsize == 1 else {"configuration": {"endian": "little"}}
    return {
        "shape": list(shape),
        "data_type": dtype,
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": list(chunks)}},
        # One directory an array instead of one a dimension: there is less to sync.
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "."}},
        "fill_value": kind.type(0).item(),
        "codecs": [
            {"name": "bytes", **endian},
            # The checksum finds a changed byte.
            {"name": "zstd", "configuration": {"level": _ZSTD_LEVEL, "checksum": True}},
        ],
        "attributes": {},
        "zarr_format": 3,
        "node_type": "array",
        "storage_transformers": [],
    }


@lru_cache(maxsize=256)
def metadata_file(shape: tuple[int, ...], dtype: str, chunks: tuple[int, ...]) -> bytes:
    """The file of `array_metadata`."""
    return _encoded(array_metadata(shape, dtype, chunks))


def array_files(values: NDArray, chunks: tuple[int, ...]) -> Iterator[File]:
    """The files of an array of `values`.

    Every chunk is written, also one of zeros, which would look the same as a lost one.
    """
    yield METADATA, metadata_file(values.shape, values.dtype.name, chunks)
    for place in places(values.shape, chunks):
        yield chunk_key(place), encoded(values[box(place, chunks)], chunks)


def places(shape: tuple[int, ...], chunks: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """Yield the place of each chunk in the grid."""
    return product(*(range(-(-size // chunk)) for size, chunk in zip(shape, chunks, strict=True)))


def box(place: tuple[int, ...], chunks: tuple[int, ...]) -> tuple[slice, ...]:
    """Return which part of an array the chunk at `place` holds."""
    return tuple(slice(i * size, (i + 1) * size) for i, size in zip(place, chunks, strict=True))


def chunk_key(place: tuple[int, ...]) -> str:
    """Return the name of the file of a chunk."""
    return ".".join(map(str, ("c", *place)))


def encoded(part: NDArray, chunks: tuple[int, ...]) -> bytes:
    """A chunk of an array, filled up with zeros where it reaches over the edge."""
    little = part.astype(part.dtype.newbyteorder("<"), copy=False)
    if part.shape == chunks:
        whole = np.ascontiguousarray(little)
    else:
        whole = np.zeros(chunks, little.dtype)
        whole[tuple(map(slice, part.shape))] = little
    return Zstd(level=_ZSTD_LEVEL, checksum=True).encode(whole)


def decoded(
    content: bytes, dtype: str, chunks: tuple[int, ...], into: NDArray | None = None
) -> NDArray:
    """The inverse of `encoded`; raises ValueError for whatever would not give exactly a chunk.

    No memory is taken for content that tells of another size, and none but that of `into` where it
    is given: an array in C order of that very type and shape.
    """
    kind = np.dtype(dtype).newbyteorder("<")
    size = math.prod(chunks) * kind.itemsize
    if zstd_told_bytes(content) != size:
        raise ValueError(f"wanted a block of {size} bytes, compressed by zstd")
    whole = np.empty(chunks, kind) if into is None or kind != into.dtype else into
    try:
        Zstd().decode(content, out=whole)
    except RuntimeError as error:
        raise ValueError(str(error)) from error
    return whole.astype(np.dtype(dtype), copy=False)


def files_of(folder: str, files: Iterable[File]) -> Iterator[File]:
    """Yield the same files, in a `folder`."""
    return ((f"{folder}/{path}", content) for path, content in files)


def _encoded(metadata: Mapping[str, Any]) -> bytes:
    # Python's encoder is ten times as fast without indentation.
    return json.dumps(metadata, allow_nan=False).encode()
