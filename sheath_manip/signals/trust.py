"""Whether the expert's labels in such states speak for what the policy will do, or against it.

The trust score of Jiang, Kim, Guan & Gupta (2018, 'To trust or not to trust a classifier') is the
distance to the nearest training state of any other class over that to the nearest of the class
predicted. A precedent alone (`PrecedentSignal`) may be an accident: one label among thousands that
the policy does not bend to, or a state that only looks the same. So here a proposal must be backed
by several precedents, while one objection is enough to be weighed.
"""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Agreement, Arrays, Embedding, PredictingPolicy, Reader
from sheath_manip.signals.labelled_states import LabelledStates
from sheath_manip.signals.single import SingleMeasure
from sheath_manip.types.seen import Precedents, Seen

RESOLUTION = 0.02
"""of the spread of the training states: closer ones are the same, so that of two copies with
different labels neither wins by rounding"""


class TrustSignal(SingleMeasure):
    """How much nearer the precedents of a proposal are than the nearest objection to it.

    With p the distance to the k-th nearest training state that has the proposed action as its
    label, and q that to the nearest with another one, the score is (q - p) / (q + p): above 0 where
    the precedents are nearer, at most 1. It ranks as the ratio q / p of the paper does.
    """

    def __init__(self, embedding: Embedding, precedents: int = 2, tolerance: float = 0.1) -> None:
        """Store the hyperparameters; ParameterError for fewer than one precedent.

        Args:
            embedding: in whose vectors the distances are taken.
            precedents: k >= 1.
            tolerance: see `LabelledStates`.
        """
        if precedents < 1:
            raise ParameterError(f"precedents is {precedents}; wanted at least 1, like 2")
        self.states = LabelledStates(embedding, tolerance)
        self.precedents = precedents

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
        return self._measured()

    def score(self, seen: Seen) -> NDArray[np.float64]:
        """Return (n,) in -1..1: -1 with too few precedents, 1 with enough and no objection."""
        against = self.states.unlike(seen)
        backed = self.states.alike(seen, self.precedents)
        with np.errstate(invalid="ignore"):
            score = (against - backed) / (against + backed + self._resolution)
        score = np.where(np.isinf(against), 1.0, score)
        return np.where(np.isinf(backed), -1.0, score)

    def nearest_states(self, seen: Seen, count: int) -> Precedents | None:
        """Return the training states nearest to one state."""
        return self.states.nearest(seen, count)

    def arrays(self) -> Arrays:
        """Return the arrays of `LabelledStates`."""
        return self.states.arrays()

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        self.states.load(arrays)
        return self._measured()

    def _measured(self) -> Self:
        spread = float(np.sqrt(self.states.vectors_.var(axis=0, dtype=np.float64).sum()))
        self._resolution = RESOLUTION * spread if spread > 0 else 1.0
        return self
