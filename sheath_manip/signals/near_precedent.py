"""How near to what the policy is about to do the expert has come, in states like this one.

For continuous actions. `PrecedentSignal` asks for the same action within a tolerance, and of seven
numbers one is nearly always off: on the grasp in clutter an eighth of new expert steps, and a fifth
of a policy's steps in episodes that succeed, had no precedent at all. Here state and action make
one vector, so that a little of both is a little.
"""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.protocols import (
    Agreement,
    Arrays,
    Embedding,
    HasOwnFrame,
    PredictingPolicy,
    Reader,
)
from sheath_manip.signals.nearest import nearest
from sheath_manip.signals.nearest_rows import distances, rows_of
from sheath_manip.signals.single import SingleMeasure
from sheath_manip.types.seen import Precedents, Seen

LEAST_RANGE = 0.1
"""of the labels in a dimension, as a share of their largest"""


class NearPrecedentSignal(SingleMeasure):
    """Minus the distance to the nearest training state and its label, as one vector."""

    def __init__(self, embedding: Embedding, action_weight: float = 2.0) -> None:
        """Store the hyperparameters; ParameterError for a weight that is not positive.

        Args:
            embedding: in whose vectors the distance of states is taken, in units of their spread.
            action_weight: what the square of a deviation by the whole range of the labels counts,
                in those units. From .5 to 8 the grasp in clutter knows little difference.
        """
        if not action_weight > 0:
            raise ParameterError(f"action_weight is {action_weight}; wanted more than 0, like 2")
        self.embedding = embedding
        self.action_weight = action_weight

    @property
    def uses_displaced(self) -> bool:
        """Whether the embedding's `fit` needs `Seen.displaced`."""
        return self.embedding.uses_displaced

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read what the embedding reads; compare actions in the policy's own frame, if any."""
        self._frame = policy if isinstance(policy, HasOwnFrame) else None
        return self.embedding.attach(policy)

    def fit(self, labels: NDArray, seen: Seen, agreement: Agreement | None = None) -> Self:
        """Keep the vectors and labels of the policy's training states."""
        del agreement
        vectors = self.embedding.fit(seen).transform(seen)
        spread = float(vectors.var(axis=0, dtype=np.float64).sum())
        self.unit_ = np.float32(1 / np.sqrt(spread) if spread > 0 else 1.0)
        framed = self._framed(labels, seen.features)
        # Of a dimension that hardly moves, least of all a fixed one, the squares would swallow all
        # other distances in float32.
        least = np.maximum(LEAST_RANGE * np.abs(framed).max(axis=0), 1e-6)
        moved = np.maximum(np.ptp(framed, axis=0), least)
        self.action_units_ = np.asarray(np.sqrt(self.action_weight) / moved, np.float32)
        return self._take(self._joined(vectors, framed))

    def score(self, seen: Seen) -> NDArray[np.float64]:
        """(n,) minus the distance: 0 on a training state where the policy does as labelled."""
        actions = self._framed(seen.actions, seen.features)
        joined = self._joined(self.embedding.transform(seen), actions)
        return -distances(self._rows.nearest(joined)[:, 0])

    def nearest_states(self, seen: Seen, count: int) -> Precedents | None:
        """Return the training states nearest to one state; actions as the policy sees them."""
        size = len(self.action_units_)
        proposed = self._framed(seen.actions, seen.features)[0]
        labels = self.joined_[:, -size:] / self.action_units_
        state = self.unit_ * self.embedding.transform(seen)[0]
        return nearest(state, self.joined_[:, :-size], labels, proposed, count)

    def arrays(self) -> Arrays:
        """The embedding's, the units, and the (n, d + a) states and labels in them."""
        learned = {
            "joined": self.joined_,
            "unit": np.array(self.unit_),
            "action_units": self.action_units_,
        }
        return {**flatten({"embedding": self.embedding.arrays()}), **learned}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        self.embedding.load(subtree(arrays, "embedding"))
        self.unit_ = np.float32(arrays["unit"])
        self.action_units_ = np.asarray(arrays["action_units"], np.float32)
        return self._take(arrays["joined"])

    def _framed(self, actions: NDArray, features: NDArray) -> NDArray[np.float32]:
        """(n, a) as the policy sees them."""
        return actions if self._frame is None else self._frame.in_own_frame(actions, features)

    def _joined(self, vectors: NDArray, actions: NDArray) -> NDArray[np.float32]:
        return np.concatenate(
            [self.unit_ * vectors, self.action_units_ * actions], axis=1, dtype=np.float32
        )

    def _take(self, joined: NDArray) -> Self:
        self.joined_ = np.asarray(joined, np.float32)
        self._rows = rows_of(self.joined_)
        return self
