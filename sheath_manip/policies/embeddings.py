"""What the embeddings have in common: readings side by side, and a scaling fitted to them."""

from abc import ABC, abstractmethod
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.scaling import Scaling, Standardisation
from sheath_manip.protocols import Arrays, PredictingPolicy, Reader
from sheath_manip.types.seen import Seen


class ScaledEmbedding(ABC):
    """Readings of the policy's looks, side by side, and the scaling fitted to them.

    It reads the policy that it was attached to: after the policy's next fit, fit it again.
    """

    def __init__(self, scaling: Scaling | None = None) -> None:
        self.scaling: Scaling = Standardisation() if scaling is None else scaling
        self._policy: PredictingPolicy | None = None
        self._readers: tuple[Reader, ...] = ()

    @property
    def uses_displaced(self) -> bool:
        """Whether the scaling contrasts with states that the robot never was in."""
        return self.scaling.uses_displaced

    @abstractmethod
    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Return what is read of a look; ParameterError where the policy lacks what is needed."""

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read looks of `policy` from now on; return all that is to be read of each."""
        if policy is not self._policy:
            self._policy, self._readers = policy, self.readers(policy)
        return self._readers

    def fit(self, seen: Seen) -> Self:
        """Fit the scaling to the training states, and to displaced ones if it asks."""
        elsewhere = None if seen.displaced is None else seen.displaced.of(self._readers)
        self.scaling.fit(seen.of(self._readers), elsewhere if self.uses_displaced else None)
        return self

    def transform(self, seen: Seen) -> NDArray[np.float32]:
        """(n, k) scaled vectors."""
        return self.scaling.transform(seen.of(self._readers))

    def arrays(self) -> Arrays:
        """The scaling's learned state."""
        return self.scaling.arrays()

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        self.scaling.load(arrays)
        return self
