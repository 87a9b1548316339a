"""The search of `nearest_rows.py` on a device, which only the distances asked for leave."""

import numpy as np
import torch
from numpy.typing import NDArray

TILE = 1 << 27
"""distances at once, 512 MB"""


class DeviceRows:
    """Squared Euclidean distances from new vectors to fixed ones, by one product of torch."""

    def __init__(self, rows: NDArray[np.float32], device: torch.device) -> None:
        """Take (m, d) fixed vectors, m >= 0, to `device`."""
        self._device = device
        there = self._there(rows)
        self._lengths = (there * there).sum(dim=1)
        self._columns = (-2 * there.T).contiguous()

    def squares(self, rows: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return (n, m) to all; rounding may leave one a little below 0."""
        return self._all(self._there(rows)).cpu().numpy()

    def nearest(self, rows: NDArray[np.float32], count: int = 1) -> NDArray[np.float32]:
        """Return (n, count) to the nearest, in any order but for the last, the farthest of them.

        Infinite where there are fewer.
        """
        found = np.full((len(rows), count), np.float32(np.inf))
        there = min(count, len(self._lengths))
        if there == 0:
            return found
        height = max(1, TILE // len(self._lengths))
        for first in range(0, len(rows), height):
            some = slice(first, first + height)
            squares = self._all(self._there(rows[some]))
            smallest = squares.topk(there, dim=1, largest=False, sorted=True).values
            # The infinite ones of too few stay behind, as the farthest.
            found[some, :there] = smallest.cpu().numpy()
        return found

    def _all(self, rows: torch.Tensor) -> torch.Tensor:
        squares = torch.addmm(self._lengths, rows, self._columns)
        return squares.add_((rows * rows).sum(dim=1, keepdim=True))

    def _there(self, array: NDArray) -> torch.Tensor:
        return torch.from_numpy(np.ascontiguousarray(array, np.float32)).to(self._device)
