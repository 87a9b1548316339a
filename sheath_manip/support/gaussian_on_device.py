"""The sums of `gaussian.py` on a device: its products by torch, which hold more rows at once."""

import numpy as np
import torch
from numpy.typing import NDArray

TILE = 1 << 26
"""entries of the kernel at once, 256 MB"""


class DeviceColumns:
    """Σ w_j exp(-|x - v_j|²/c) over fixed vectors v_j, for the left factors of any x."""

    def __init__(self, vectors: NDArray, weights: NDArray, c: float, device: torch.device) -> None:
        """Take (m, d) vectors and their (m,) weights to `device`."""
        self._device = device
        there = self._there(vectors)
        squared = (there * there).sum(dim=1, keepdim=True) / c
        # In the order of a left factor: the vector, its square, and 1.
        factors = [there * (2 / c), torch.full_like(squared, -1 / c), -squared]
        self._factor = torch.cat(factors, dim=1).T.contiguous()
        self._weights = self._there(weights)

    def sum_of(self, row: NDArray[np.float32]) -> float:
        """The sum for one (d + 2,) row of a left factor."""
        return float(self.sums(row[None])[0])

    def sums(self, rows: NDArray[np.float32]) -> NDArray[np.float64]:
        """Return the (n,) sums for an (n, d + 2) left factor."""
        height = max(1, TILE // max(1, len(self._weights)))
        parts = [
            self._tile(self._there(rows[first : first + height]))
            for first in range(0, len(rows), height)
        ]
        return np.concatenate([np.empty(0), *(part.double().cpu().numpy() for part in parts)])

    def _tile(self, rows: torch.Tensor) -> torch.Tensor:
        # What rounds above 0 is as near as can be.
        return torch.exp((rows @ self._factor).clamp_(max=0)) @ self._weights

    def _there(self, array: NDArray) -> torch.Tensor:
        return torch.from_numpy(np.ascontiguousarray(array, np.float32)).to(self._device)
