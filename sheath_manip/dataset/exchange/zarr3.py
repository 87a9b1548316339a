"""What zarr's format 3 says of an array.

Format: https://zarr-specs.readthedocs.io/en/latest/v3/core/index.html
"""

from typing import Any

import google_crc32c
import numpy as np

from sheath_manip.dataset.exchange.codecs import Decode, decoder
from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.dataset.exchange.plain_tree import PlainTree, read_json
from sheath_manip.dataset.exchange.zarr_array import ArrayMeta, fill_value, lengths
from sheath_manip.exceptions import StoreError

NODE = "zarr.json"
COMPRESSORS = ("blosc", "gzip", "zstd")
CHECKSUM, CHECKSUM_BYTES = "crc32c", 4
_TYPES = ("bool", *(f"{kind}{bits}" for kind in ("int", "uint") for bits in (8, 16, 32, 64)))
TYPES = (*_TYPES, "float16", "float32", "float64")


def read_meta(tree: PlainTree, path: str, limits: Limits) -> ArrayMeta:
    """Read it; StoreError or ValueError where an array is of another kind than is read here."""
    told = read_json(tree, f"{path}/{NODE}", limits)
    if not isinstance(told, dict) or told.get("zarr_format") != 3 or _kind(told) != "array":
        raise StoreError(f"{path} is no array of zarr's format 3")
    if told["data_type"] not in TYPES or told.get("storage_transformers"):
        raise StoreError(f"{path} holds {told['data_type']!r:.60}; wanted booleans or numbers")
    grid, encoding = told["chunk_grid"], told["chunk_key_encoding"]
    chosen = encoding.get("configuration") or {}
    if grid["name"] != "regular" or encoding["name"] not in ("default", "v2"):
        raise StoreError(f"{path} has a grid {grid!r:.60}; wanted a regular one, and plain keys")
    default = encoding["name"] == "default"
    separator = chosen.get("separator", "/" if default else ".")
    if separator not in (".", "/"):
        raise StoreError(f"{path} has the separator {separator!r:.20}; wanted . or /")
    dtype, decode = _codecs(path, told["codecs"], np.dtype(told["data_type"]))
    return ArrayMeta(
        shape=lengths(told["shape"], 0),
        chunks=lengths(grid["configuration"]["chunk_shape"], 1),
        dtype=dtype,
        fill=fill_value(told.get("fill_value"), dtype),
        decode=decode,
        prefix=f"c{separator}" if default else "",
        separator=separator,
    )


def is_group(told: Any) -> bool:
    """Whether that is what format 3 says of a group."""
    return isinstance(told, dict) and told.get("zarr_format") == 3 and _kind(told) == "group"


def _kind(told: dict[str, Any]) -> Any:
    return told.get("node_type")


def _codecs(path: str, told: list[Any], dtype: np.dtype) -> tuple[np.dtype, Decode]:
    """The numbers' type with their order of bytes, and what decodes a chunk."""
    names = [codec["name"] for codec in told]
    first, *rest = names
    checked = rest[-1:] == [CHECKSUM]
    compressors = rest[: len(rest) - checked]
    if first != "bytes" or len(compressors) > 1 or not set(compressors) <= set(COMPRESSORS):
        raise StoreError(
            f"{path} has the codecs {', '.join(map(str, names))!r:.80}; wanted bytes, then at most "
            f"one of {', '.join(COMPRESSORS)}, then at most {CHECKSUM}"
        )
    endian = (told[0].get("configuration") or {}).get("endian", "little")
    decode = decoder(compressors[0] if compressors else None)
    ordered = dtype.newbyteorder("<" if endian == "little" else ">")
    return ordered, _checked(decode) if checked else decode


def _checked(decode: Decode) -> Decode:
    def checked(content: bytes, size: int) -> bytes:
        inside, told = content[:-CHECKSUM_BYTES], content[-CHECKSUM_BYTES:]
        if google_crc32c.value(inside).to_bytes(CHECKSUM_BYTES, "little") != told:
            raise ValueError("a block has another checksum than it tells")
        return decode(inside, size)

    return checked
