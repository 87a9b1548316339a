"""The observation's features as the vector on which the support is estimated."""

from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.embeddings import ScaledEmbedding
from sheath_manip.policies.readings import ObservedFeatures
from sheath_manip.protocols import Arrays, PredictingPolicy, Reader
from sheath_manip.types.seen import Seen


@final
class ScaledFeatures(ScaledEmbedding):
    """`Observation.features`, each in units of its own spread; needs nothing of the policy.

    For features of different units, such as angles beside metres.
    """

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, f)."""
        del policy
        return (ObservedFeatures(),)


@final
class Features:
    """`Observation.features` as they are, not scaled; needs nothing of the policy.

    Of binary features the squared distance is the number of those that differ, which scaling would
    blur by blowing up the rare ones. For tasks whose features are what the policy looks at: where
    they hold what only the simulator knows, the support would be estimated on that.
    """

    uses_displaced = False

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read the features alone."""
        del policy
        return ()

    def fit(self, seen: Seen) -> Self:
        """Return self: there is nothing to learn."""
        del seen
        return self

    def transform(self, seen: Seen) -> NDArray[np.float32]:
        """(n, f) the features."""
        return np.asarray(seen.features, dtype=np.float32)

    def arrays(self) -> Arrays:
        """Return no arrays, since nothing is learned."""
        return {}

    def load(self, arrays: Arrays) -> Self:
        """Do nothing: there is nothing to take over."""
        del arrays
        return self
