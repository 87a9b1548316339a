"""Arrays of zarr's format 2, read without zarr: what they say is held against a list beforehand.

zarr decodes whatever codec and type a file names, follows links, and takes the memory that a file
asks for. Format: https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html
"""

import math
import re
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.exchange.codecs import decoder
from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.dataset.exchange.plain_tree import PlainTree, read_json
from sheath_manip.exceptions import StoreError

MOST_DIMENSIONS = 8
MOST_CHUNKS = 1_000_000
BLOCK_OVERHEAD_BYTES = 1 << 16
_DTYPE = re.compile(r"\|b1|\|[iu]1|[<>][iu][248]|[<>]f[248]")
"""booleans, whole numbers and floats; not objects, text, structures or times"""


class Zarr2Array:
    """One array; StoreError or ValueError where it is of another kind than is read here."""

    def __init__(self, tree: PlainTree, path: str, limits: Limits) -> None:
        """Read its metadata, and nothing else."""
        self.path = path
        self._tree = tree
        self._limits = limits
        told = read_json(tree, f"{path}/.zarray", limits)
        if not isinstance(told, dict) or told.get("zarr_format") != 2:
            raise StoreError(f"{path} is no array of zarr's format 2")
        self.shape = _lengths(told["shape"], 0)
        self.chunks = _lengths(told["chunks"], 1)
        if len(self.shape) != len(self.chunks):
            raise StoreError(f"{path} has shape {self.shape} and chunks {self.chunks}")
        if not isinstance(told["dtype"], str) or not _DTYPE.fullmatch(told["dtype"]):
            raise StoreError(
                f"{path} holds {told['dtype']!r:.60}; wanted booleans or numbers, such as '<f4'"
            )
        self.dtype = np.dtype(told["dtype"])
        if told.get("filters"):
            raise StoreError(f"{path} has filters ({told['filters']!r:.60}); wanted none")
        compressor = told["compressor"] or {"id": None}
        self._decode = decoder(compressor["id"])
        self._order = told["order"]
        self._separator = told.get("dimension_separator", ".")
        if self._order not in ("C", "F") or self._separator not in (".", "/"):
            raise StoreError(f"{path} has order {self._order!r:.20}; wanted C or F")
        self._fill = _fill(told.get("fill_value"), self.dtype)
        self._grid = [-(-n // chunk) for n, chunk in zip(self.shape, self.chunks, strict=True)]
        self._chunk_bytes = math.prod(self.chunks) * self.dtype.itemsize
        if math.prod(self._grid) > MOST_CHUNKS:
            raise StoreError(f"{path} has {math.prod(self._grid)} chunks; at most {MOST_CHUNKS}")
        self.row_bytes = math.prod(self.shape[1:]) * self.dtype.itemsize
        limits.require_memory(f"a chunk of {path}", self._chunk_bytes)

    def rows(self, start: int, stop: int) -> NDArray:
        """(stop - start, ...) some rows; raises StoreError or ValueError where they do not decode.

        A chunk that is missing holds the value that the metadata give for that.
        """
        self._limits.require_memory(self.path, self.row_bytes * (stop - start))
        rows = np.full((stop - start, *self.shape[1:]), self._fill, self.dtype)
        if not rows.size:
            return rows
        first, last = start // self.chunks[0], -(-stop // self.chunks[0])
        for place in product(range(first, last), *map(range, self._grid[1:])):
            self._limits.require_time()
            if self._key(place) in self._tree.sizes:
                self._put(place, start, rows)
        return rows.astype(self.dtype.newbyteorder("="), copy=False)

    def missing(self) -> int:
        """Return how many of its chunks are not there."""
        keys = (self._key(place) for place in product(*map(range, self._grid)))
        return sum(key not in self._tree.sizes for key in keys)

    def _put(self, place: tuple[int, ...], start: int, rows: NDArray) -> None:
        """Write the part of a chunk that is asked for into its place in `rows`."""
        key = self._key(place)
        # No compression makes a block that much larger.
        if self._tree.sizes[key] > 2 * self._chunk_bytes + BLOCK_OVERHEAD_BYTES:
            raise StoreError(f"{key} has {self._tree.sizes[key]} bytes for {self._chunk_bytes}")
        content = self._decode(self._tree.read(key), self._chunk_bytes)
        chunk = np.frombuffer(content, self.dtype).reshape(self.chunks, order=self._order)
        corner = [n * size for n, size in zip(place, self.chunks, strict=True)]
        corner[0] -= start
        inside, outside = [], []
        for at, size, length in zip(corner, self.chunks, rows.shape, strict=True):
            low, high = max(at, 0), min(at + size, length)
            inside.append(slice(low, high))
            outside.append(slice(low - at, high - at))
        rows[tuple(inside)] = chunk[tuple(outside)]

    def _key(self, place: tuple[int, ...]) -> str:
        return f"{self.path}/{self._separator.join(map(str, place))}"


def _lengths(told: Any, least: int) -> tuple[int, ...]:
    fits = isinstance(told, list) and 1 <= len(told) <= MOST_DIMENSIONS
    if not fits or not all(type(n) is int and least <= n < 2**62 for n in told):
        raise StoreError(f"a shape is {told!r:.60}; wanted 1 to {MOST_DIMENSIONS} whole numbers")
    return tuple(told)


def _fill(told: Any, dtype: np.dtype) -> Any:
    if told is None:
        return dtype.type(0)
    if dtype.kind == "f" and told in ("NaN", "Infinity", "-Infinity"):
        return dtype.type(told)
    if not isinstance(told, int | float):
        raise StoreError(f"a fill value is {told!r:.60}; wanted a number")
    with np.errstate(all="ignore"):
        return dtype.type(told)
