"""How near the nearest of many fixed vectors are."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sheath_manip.rollout.device import is_cpu, torch_device

# Rows compared at once: with 10,000 fixed ones their distances take 40 MB.
BATCH = 1024


class Rows(Protocol):
    """Squared Euclidean distances from new vectors to fixed ones."""

    def squares(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (n, m) to all; rounding may leave one a little below 0."""
        ...

    def nearest(self, rows: NDArray[np.float32], count: int = 1) -> NDArray[np.float32]:
        """Return (n, count) to the nearest, in any order but for the last, the farthest of them.

        Infinite where there are fewer.
        """
        ...


def rows_of(rows: NDArray[np.float32]) -> Rows:
    """Return the distances to (m, d) fixed vectors, where this process computes."""
    if is_cpu():
        return NearestRows(rows)
    # Only now: the CPU does without torch.
    from sheath_manip.signals.nearest_on_device import DeviceRows

    return DeviceRows(rows, torch_device())


class NearestRows:
    """Squared Euclidean distances from new vectors to fixed ones, by one product."""

    def __init__(self, rows: NDArray[np.float32]) -> None:
        """Take (m, d) fixed vectors, m >= 0."""
        self._lengths = np.vecdot(rows, rows)
        # Laid out so that one row times it runs fastest.
        self._columns = np.ascontiguousarray(-2 * rows.T)

    def squares(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (n, m) to all; rounding may leave one a little below 0."""
        return self._less_own(rows) + np.vecdot(rows, rows)[:, None]

    def nearest(self, rows: NDArray[np.float32], count: int = 1) -> NDArray[np.float32]:
        """Return (n, count) to the nearest, in any order but for the last, the farthest of them.

        Infinite where there are fewer.
        """
        there = min(count, len(self._lengths))
        if there < count:
            missing = np.full((len(rows), count - there), np.float32(np.inf))
            return (
                np.concatenate([self.nearest(rows, there), missing], axis=1) if there else missing
            )
        parts = [
            smallest(self._less_own(rows[first : first + BATCH]), count)
            for first in range(0, max(len(rows), 1), BATCH)
        ]
        found = parts[0] if len(parts) == 1 else np.concatenate(parts)
        found += np.vecdot(rows, rows)[:, None]
        return found

    def _less_own(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (n, m) squared distances, less each new row's own squared length."""
        products = rows @ self._columns
        products += self._lengths
        return products


def smallest(numbers: NDArray[np.float32], count: int) -> NDArray[np.float32]:
    """Return the (n, count) smallest of (n, m >= count), the largest of them last."""
    if count == 1:
        return numbers.min(axis=1, keepdims=True)
    return np.partition(numbers, count - 1, axis=1)[:, :count]


def distances(squares: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the distances, roots of the squared ones."""
    return np.sqrt(np.maximum(squares, 0), dtype=np.float64)
