"""States as a policy saw them: looked at once, for all who want to know something of them."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Seen:
    """n states that one policy has looked at once, with one set of weights."""

    features: NDArray[np.float32]
    """(n, f) as observed"""
    actions: NDArray[np.float32]
    """(n, a) what the policy would do"""
    readings: Mapping[Hashable, NDArray[np.float32]]
    """(n, d) what each reader took of the looks"""
    losses: NDArray[np.float32] | None = None
    """(n,) how far the actions are from their labels, NaN where there is none; None: not asked"""
    displaced: "Seen | None" = None
    """made-up states that the robot never was in, for embeddings that contrast with them"""

    def __len__(self) -> int:
        return len(self.actions)

    def of(self, readers: Sequence[Hashable]) -> NDArray[np.float32]:
        """(n, d) what these readers took, side by side."""
        taken = [self.readings[reader] for reader in readers]
        return taken[0] if len(taken) == 1 else np.concatenate(taken, axis=1)
