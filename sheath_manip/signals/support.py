"""Whether a state is like those that the policy was trained on: SHEATH's own signal."""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.protocols import (
    Agreement,
    Arrays,
    Embedding,
    HasFloor,
    PredictingPolicy,
    Reader,
    SupportEstimator,
)
from sheath_manip.signals.single import SingleMeasure
from sheath_manip.types import Reason
from sheath_manip.types.seen import Seen


class SupportSignal(SingleMeasure):
    """A support estimator on an embedding of the observation."""

    reason = Reason.OUTSIDE

    def __init__(self, embedding: Embedding, support: SupportEstimator) -> None:
        self.embedding = embedding
        self.support = support

    @property
    def uses_displaced(self) -> bool:
        """Whether the embedding's `fit` needs `Seen.displaced`."""
        return self.embedding.uses_displaced

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read what the embedding reads."""
        return self.embedding.attach(policy)

    def fit(self, labels: NDArray, seen: Seen, agreement: Agreement | None = None) -> Self:
        """Fit embedding and support to the policy's training states."""
        del labels
        vectors = self.embedding.fit(seen).transform(seen)
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

    def refit(self, seen: Seen) -> Self:
        """Fit the support again to the states, on the embedding as it is."""
        if self.support.uses_agreement:
            raise ParameterError(
                f"{type(self.support).__name__} asks where the policy is right, which takes a "
                "training run to say; wanted a support that is fitted to the states alone"
            )
        self.support.fit(self.embedding.transform(seen))
        return self

    def score(self, seen: Seen) -> NDArray[np.float64]:
        """(n,) support scores, positive inside."""
        return self.support.decision_function(self.embedding.transform(seen))

    @property
    def far_score(self) -> float:
        """The score infinitely far from all training states; -inf where scores have no floor."""
        return self.support.far_score if isinstance(self.support, HasFloor) else -np.inf

    def arrays(self) -> Arrays:
        """The learned state of both."""
        return flatten({"embedding": self.embedding.arrays(), "support": self.support.arrays()})

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        self.embedding.load(subtree(arrays, "embedding"))
        self.support.load(subtree(arrays, "support"))
        return self
