"""Columns of Parquet files of others: numbers, texts and encoded images, each by its rows.

pyarrow unpacks whatever a file declares, so what a column may take is held against the limits
first; a file that lies about it meets the bound of the process that it is read in.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.exchange.limits import Limits
from sheath_manip.dataset.exchange.plain_tree import FolderTree
from sheath_manip.dataset.extras import needs
from sheath_manip.exceptions import StoreError

with needs("lerobot-data", "pyarrow"):
    import pyarrow as pa
    import pyarrow.parquet as pq

MOST_ITEM_BYTES = 8
_NUMBERS = (pa.types.is_boolean, pa.types.is_integer, pa.types.is_floating)
_LISTS = (pa.types.is_list, pa.types.is_large_list, pa.types.is_fixed_size_list)


class Parquet:
    """One file; its rows are read a part at a time."""

    def __init__(self, tree: FolderTree, file: str, limits: Limits) -> None:
        """Read what the file says of itself, and no row."""
        self.file = file
        self._limits = limits
        self._tree = tree
        with tree.open(file) as opened:
            parquet = pq.ParquetFile(opened)
            self._metadata = parquet.metadata
            self.columns = tuple(parquet.schema_arrow.names)
        self._groups = tuple(map(self._metadata.row_group, range(self._metadata.num_row_groups)))
        self._starts = np.cumsum([0, *(group.num_rows for group in self._groups)])
        self.length = int(self._starts[-1])

    def numbers(self, column: str, start: int, stop: int, shape: tuple[int, ...]) -> NDArray:
        """(stop - start, *shape) numbers; raises StoreError for anything else."""
        what = f"{column} of {self.file}"
        self._limits.require_memory(what, (stop - start) * math.prod(shape) * MOST_ITEM_BYTES)
        array = self._array(column, start, stop)
        while not _is_flat(array.type):
            _require_whole(array, what)
            fixed = pa.types.is_fixed_size_list(array.type)
            if not fixed and len(array.value_lengths().unique()) > 1:
                raise StoreError(f"{what} has rows of several lengths")
            array = array.flatten()
        _require_whole(array, what)
        if not any(is_kind(array.type) for is_kind in _NUMBERS):
            raise StoreError(f"{what} holds {array.type}; wanted booleans or numbers")
        if len(array) != (stop - start) * math.prod(shape):
            raise StoreError(f"{what} has {len(array)} numbers; wanted {stop - start} of {shape}")
        return array.to_numpy(zero_copy_only=False).reshape(stop - start, *shape)

    def rows(self, column: str, start: int, stop: int) -> list[Any]:
        """Return texts, lists or structures, as Python has them."""
        return self._array(column, start, stop).to_pylist()

    def _array(self, column: str, start: int, stop: int) -> Any:
        if column not in self.columns:
            raise StoreError(f"{self.file} has no column {column!r}; it has {self.columns}")
        if not 0 <= start <= stop <= self.length:
            raise StoreError(f"{self.file} has {self.length} rows; wanted those to {stop}")
        first = int(np.searchsorted(self._starts, start, "right")) - 1
        last = int(np.searchsorted(self._starts, stop, "left"))
        groups = list(range(max(first, 0), last))
        told = (self._column_bytes(group, column) for group in groups)
        self._limits.require_memory(f"{column} of {self.file}", sum(told))
        with self._tree.open(self.file) as opened:
            parquet = pq.ParquetFile(opened, metadata=self._metadata)
            table = parquet.read_row_groups(groups, columns=[column], use_threads=False)
        begin = start - int(self._starts[groups[0]]) if groups else 0
        whole = table.column(column).slice(begin, stop - start).combine_chunks()
        return whole.storage if isinstance(whole, pa.ExtensionArray) else whole

    def _column_bytes(self, group: int, column: str) -> int:
        """Return what the parts of a column declare that they take unpacked."""
        parts = map(self._groups[group].column, range(self._groups[group].num_columns))
        return sum(
            part.total_uncompressed_size
            for part in parts
            if part.path_in_schema == column or part.path_in_schema.startswith(f"{column}.")
        )


def _is_flat(kind: Any) -> bool:
    return not any(is_list(kind) for is_list in _LISTS)


def _require_whole(array: Any, what: str) -> None:
    if array.null_count:
        raise StoreError(f"{what} has {array.null_count} rows without a value")
