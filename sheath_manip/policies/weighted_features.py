"""The observation's features, each as large as the policy makes it: a learned metric."""

from typing import Protocol, Self, final, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.readings import NAMED_BY
from sheath_manip.protocols import Arrays, PredictingPolicy, Reader
from sheath_manip.types.seen import Seen


@runtime_checkable
class LooksAtFeatures(Protocol):
    """A policy that can say how much it makes of each feature."""

    def feature_weights(self) -> NDArray[np.float32]:
        """Return (f,) weights, at least 0."""
        ...


@final
class WeightedFeatures:
    """`Observation.features`, each times the norm of its weights in the policy's machines.

    What the policy does not look at cannot change what it does, and what it looks at hard can with
    a single bit: so two states are far apart where the policy's scores could differ much. A linear
    policy's scores W φ differ by W δ; of the metric WᵀW this is the diagonal, so that differences
    which cancel out today, and need not after the next fit, count all the same.
    """

    uses_displaced = False

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Weigh as `policy` does; ParameterError where it does not tell."""
        if not isinstance(policy, LooksAtFeatures):
            raise ParameterError(
                f"{type(policy).__name__} does not say what it makes of each feature; wanted a "
                "policy with feature_weights(), like linear-svm, or the embedding 'features': "
                f"{NAMED_BY}"
            )
        self._policy: LooksAtFeatures = policy
        return ()

    def fit(self, seen: Seen) -> Self:
        """Take the weights as they are now."""
        del seen
        weights = self._policy.feature_weights()
        # No unit follows from a margin: that of the heaviest feature is as good as any.
        self.scale_ = weights / max(float(weights.max()), 1e-12)
        return self

    def transform(self, seen: Seen) -> NDArray[np.float32]:
        """(n, f) the weighted features."""
        return np.asarray(seen.features, dtype=np.float32) * self.scale_

    def arrays(self) -> Arrays:
        """The (f,) scale."""
        return {"scale": self.scale_}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError for another shape."""
        self.scale_ = numbers(arrays, "scale", None).astype(np.float32)
        return self
