"""An embedding: the features and their squares."""

from typing import Self

import numpy as np

from sheath_manip.protocols import Arrays, PredictingPolicy, Reader
from sheath_manip.types.seen import Seen


class Squares:
    """Needs nothing of the policy, and learns nothing."""

    uses_displaced = False

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read the features alone."""
        del policy
        return ()

    def fit(self, seen: Seen) -> Self:
        """There is nothing to learn."""
        del seen
        return self

    def transform(self, seen: Seen) -> np.ndarray:
        """(n, 2 f) both, side by side."""
        return np.concatenate([seen.features, seen.features**2], axis=1).astype(np.float32)

    def arrays(self) -> Arrays:
        """Nothing is learned."""
        return {}

    def load(self, arrays: Arrays) -> Self:
        """There is nothing to take over."""
        del arrays
        return self
