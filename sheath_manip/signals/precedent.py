"""Whether the expert has done, in such a state, what the policy is about to do.

The support says that a state is familiar. A policy may err there all the same: where the states
like it got other labels. So the distance is taken to the nearest training state in which the expert
did what the policy proposes: nearest neighbours (Knox & Ng 1998) of state AND action.
"""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Agreement, Arrays, Embedding, PredictingPolicy, Reader
from sheath_manip.signals.labelled_states import LabelledStates
from sheath_manip.signals.single import SingleMeasure
from sheath_manip.types.seen import Precedents, Seen


class PrecedentSignal(SingleMeasure):
    """Minus the distance to the nearest training state with the proposed action as its label."""

    def __init__(self, embedding: Embedding, tolerance: float = 0.1) -> None:
        """Store the hyperparameters, those of `LabelledStates`."""
        self.states = LabelledStates(embedding, tolerance)

    @property
    def uses_displaced(self) -> bool:
        """Whether the embedding's `fit` needs `Seen.displaced`."""
        return self.states.embedding.uses_displaced

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read what the embedding reads."""
        return self.states.attach(policy)

    def fit(self, labels: NDArray, seen: Seen, agreement: Agreement | None = None) -> Self:
        """Keep the policy's training states and their labels."""
        del agreement
        self.states.fit(labels, seen)
        return self

    def score(self, seen: Seen) -> NDArray[np.float64]:
        """(n,) minus the distance: 0 on a training state, -inf without any precedent."""
        return -self.states.alike(seen)

    def nearest_states(self, seen: Seen, count: int) -> Precedents | None:
        """Return the training states nearest to one state."""
        return self.states.nearest(seen, count)

    def arrays(self) -> Arrays:
        """Return the arrays of `LabelledStates`."""
        return self.states.arrays()

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        self.states.load(arrays)
        return self
