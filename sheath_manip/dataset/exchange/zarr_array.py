"""Arrays of zarr, read without zarr: what they say is held against a list beforehand.

zarr decodes whatever codec and type a file names, follows links, and takes the memory that a file
asks for.
"""

import math
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.exchange.codecs import Decode
from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.dataset.exchange.plain_tree import PlainTree
from sheath_manip.exceptions import StoreError

MOST_DIMENSIONS = 8
MOST_CHUNKS = 1_000_000
BLOCK_OVERHEAD_BYTES = 1 << 16


@dataclass(frozen=True)
class ArrayMeta:
    """What is said of an array, in either format."""

    shape: tuple[int, ...]
    chunks: tuple[int, ...]
    """the shape of one"""
    dtype: np.dtype
    fill: Any
    """what a chunk that is missing is full of"""
    decode: Decode
    prefix: str
    """of a chunk's file, before its place in the grid"""
    separator: str
    order: Any = "C"
    """of a chunk's numbers: C or F"""


class ZarrArray:
    """One array; StoreError where it asks for too much."""

    def __init__(self, tree: PlainTree, path: str, meta: ArrayMeta, limits: Limits) -> None:
        """Store them; no chunk is read."""
        self.path = path
        self._tree = tree
        self._limits = limits
        self._meta = meta
        self.shape, self.chunks, self.dtype = meta.shape, meta.chunks, meta.dtype
        if len(self.shape) != len(self.chunks):
            raise StoreError(f"{path} has shape {self.shape} and chunks {self.chunks}")
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
        rows = np.full((stop - start, *self.shape[1:]), self._meta.fill, self.dtype)
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
        content = self._meta.decode(self._tree.read(key), self._chunk_bytes)
        chunk = np.frombuffer(content, self.dtype).reshape(self.chunks, order=self._meta.order)
        corner = [n * size for n, size in zip(place, self.chunks, strict=True)]
        corner[0] -= start
        inside, outside = [], []
        for at, size, length in zip(corner, self.chunks, rows.shape, strict=True):
            low, high = max(at, 0), min(at + size, length)
            inside.append(slice(low, high))
            outside.append(slice(low - at, high - at))
        rows[tuple(inside)] = chunk[tuple(outside)]

    def _key(self, place: tuple[int, ...]) -> str:
        return f"{self.path}/{self._meta.prefix}{self._meta.separator.join(map(str, place))}"


def lengths(told: Any, least: int) -> tuple[int, ...]:
    """Return the shape that is told, each length at least `least`; raises StoreError for none."""
    fits = isinstance(told, list) and 1 <= len(told) <= MOST_DIMENSIONS
    if not fits or not all(type(n) is int and least <= n < 2**62 for n in told):
        raise StoreError(f"a shape is {told!r:.60}; wanted 1 to {MOST_DIMENSIONS} whole numbers")
    return tuple(told)


def fill_value(told: Any, dtype: np.dtype) -> Any:
    """Return the value that is told for chunks that are missing; raises StoreError for none."""
    if told is None:
        return dtype.type(0)
    if dtype.kind == "f" and told in ("NaN", "Infinity", "-Infinity"):
        return dtype.type(told)
    if not isinstance(told, int | float):
        raise StoreError(f"a fill value is {told!r:.60}; wanted a number")
    with np.errstate(all="ignore"):
        return dtype.type(told)
