"""The observation's features as the vector on which the support is estimated."""

from collections.abc import Mapping
from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.scaling import Standardisation
from sheath_manip.protocols import Arrays, Policy
from sheath_manip.types.samples import Samples


@final
class ScaledFeatures:
    """`Observation.features`, each in units of its own spread; needs nothing of the policy.

    For features of different units, such as angles beside metres.
    """

    def __init__(self) -> None:
        self.scaling = Standardisation()

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """Fit the scaling to the training states."""
        del policy
        self.scaling.fit(samples.features)
        return self

    def transform(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float32]:
        """(n, f) the scaled features; the images go unused."""
        del images
        return self.scaling.transform(features)

    def arrays(self) -> Arrays:
        """The scaling's learned state."""
        return self.scaling.arrays()

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        del policy
        self.scaling.load(arrays)
        return self


@final
class Features:
    """`Observation.features` as they are, not scaled; needs nothing of the policy.

    Of binary features the squared distance is the number of those that differ, which scaling would
    blur by blowing up the rare ones. For tasks whose features are what the policy looks at: where
    they hold what only the simulator knows, the support would be estimated on that.
    """

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """There is nothing to learn."""
        del policy, samples
        return self

    def transform(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float32]:
        """(n, f) the features; the images go unused."""
        del images
        return np.asarray(features, dtype=np.float32)

    def arrays(self) -> Arrays:
        """None."""
        return {}

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """There is nothing to take over."""
        del policy, arrays
        return self
