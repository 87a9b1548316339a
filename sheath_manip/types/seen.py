"""States as a policy saw them: looked at once, for all who want to know something of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Seen:
    """n states that one policy has looked at once, with one set of weights."""

    features: NDArray[np.float32]
    """(n, f) as observed"""
    actions: NDArray[np.float32]
    """(n, a) what the policy would do"""
    readings: Mapping[Any, NDArray[np.float32]]
    """(n, d) what each reader took of the looks; keyed by readers, which are hashable values"""
    losses: NDArray[np.float32] | None = None
    """(n,) how far the actions are from their labels, NaN where there is none; None: not asked"""
    displaced: "Seen | None" = None
    """made-up states that the robot never was in, for embeddings that contrast with them"""

    def __len__(self) -> int:
        return len(self.actions)

    def of(self, readers: Sequence[Any]) -> NDArray[np.float32]:
        """(n, d) what these readers took, side by side."""
        taken = [self.readings[reader] for reader in readers]
        return taken[0] if len(taken) == 1 else np.concatenate(taken, axis=1)


@dataclass(frozen=True, eq=False)
class Precedents:
    """The k training states that are nearest to a state, the nearest first."""

    indices: NDArray[np.int64]
    """(k,) places among the m training states, in the order of the fit"""
    distances: NDArray[np.float64]
    """(k,) in the embedding, in units of the training states' spread around their middle"""
    labels: NDArray[np.float32]
    """(k, a) what the expert did there"""
    proposed: NDArray[np.float32]
    """(a,) what the policy proposes, in the frame of the labels"""
    total: int
    """m"""
