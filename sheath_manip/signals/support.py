"""Whether a state is like those that the policy was trained on: SHEATH's own signal."""

from collections.abc import Mapping, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.nested_arrays import part, prefixed
from sheath_manip.protocols import Agreement, Arrays, Embedding, Policy, SupportEstimator
from sheath_manip.types.samples import Samples


class SupportSignal:
    """A support estimator on an embedding of the observation."""

    def __init__(self, embedding: Embedding, support: SupportEstimator) -> None:
        self.embedding = embedding
        self.support = support

    def fit(self, policy: Policy, states: Samples, agreement: Agreement | None = None) -> Self:
        """Fit embedding and support to the policy's training `states`."""
        vectors = self.embedding.fit(policy, states).transform(states.images, states.features)
        if not self.support.uses_agreement:
            self.support.fit(vectors)
            return self
        if agreement is None:
            raise ParameterError(
                f"{type(self.support).__name__} asks where the policy is right on held-out "
                "episodes; wanted `agreement`, like `partial(held_out_agreement, fresh_policy, "
                "states)`"
            )
        self.support.fit(vectors, agreement())
        return self

    def refit(self, states: Samples) -> Self:
        """Fit the support again to `states`, on the embedding as it is."""
        if self.support.uses_agreement:
            raise ParameterError(
                f"{type(self.support).__name__} asks where the policy is right, which takes a "
                "training run to say; wanted a support that is fitted to the states alone"
            )
        self.support.fit(self.embedding.transform(states.images, states.features))
        return self

    def calibrate(self, episodes: Sequence[Samples]) -> Self:
        """A support needs no held-out states."""
        del episodes
        return self

    def scores(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float64]:
        """(n,) support scores, positive inside."""
        return self.support.decision_function(self.embedding.transform(images, features))

    def arrays(self) -> Arrays:
        """The learned state of both."""
        return prefixed({"embedding": self.embedding.arrays(), "support": self.support.arrays()})

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over `arrays()` on top of `policy`."""
        self.embedding.load(policy, part(arrays, "embedding"))
        self.support.load(part(arrays, "support"))
        return self
