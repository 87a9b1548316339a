"""What zarr's format 2 says of an array.

Format: https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html
"""

import re

import numpy as np

from sheath_manip.dataset.exchange.codecs import decoder
from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.dataset.exchange.plain_tree import PlainTree, read_json
from sheath_manip.dataset.exchange.zarr_array import ArrayMeta, fill_value, lengths
from sheath_manip.exceptions import StoreError

ARRAY, GROUP, ATTRIBUTES = ".zarray", ".zgroup", ".zattrs"
_DTYPE = re.compile(r"\|b1|\|[iu]1|[<>][iu][248]|[<>]f[248]")
"""booleans, whole numbers and floats; not objects, text, structures or times"""


def read_meta(tree: PlainTree, path: str, limits: Limits) -> ArrayMeta:
    """Read it; StoreError or ValueError where an array is of another kind than is read here."""
    told = read_json(tree, f"{path}/{ARRAY}", limits)
    if not isinstance(told, dict) or told.get("zarr_format") != 2:
        raise StoreError(f"{path} is no array of zarr's format 2")
    if not isinstance(told["dtype"], str) or not _DTYPE.fullmatch(told["dtype"]):
        raise StoreError(
            f"{path} holds {told['dtype']!r:.60}; wanted booleans or numbers, such as '<f4'"
        )
    if told.get("filters"):
        raise StoreError(f"{path} has filters ({told['filters']!r:.60}); wanted none")
    dtype, compressor = np.dtype(told["dtype"]), told["compressor"] or {"id": None}
    order, separator = told["order"], told.get("dimension_separator", ".")
    if order not in ("C", "F") or separator not in (".", "/"):
        raise StoreError(f"{path} has order {order!r:.20}; wanted C or F")
    return ArrayMeta(
        shape=lengths(told["shape"], 0),
        chunks=lengths(told["chunks"], 1),
        dtype=dtype,
        fill=fill_value(told.get("fill_value"), dtype),
        decode=decoder(compressor["id"]),
        prefix="",
        separator=separator,
        order=order,
    )
