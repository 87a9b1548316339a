"""The policy's training states with their labels, and how far off they are from new ones."""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.protocols import Arrays, Embedding, PredictingPolicy, Reader
from sheath_manip.signals.nearest import nearest
from sheath_manip.signals.nearest_rows import BATCH, distances, rows_of, smallest
from sheath_manip.types.seen import Precedents, Seen

MOST_CHOICES = 64
"""labels that differ: with more the actions are no choices, and each has hardly a state"""


class LabelledStates:
    """Compares new states with the training states, and the policy's proposals with the labels."""

    def __init__(self, embedding: Embedding, tolerance: float = 0.1) -> None:
        """Store the hyperparameters; ParameterError for a tolerance outside 0..1.

        Args:
            embedding: in whose vectors the distances are taken.
            tolerance: in 0..1; labels and proposals count as the same action where they differ, in
                each dimension, by at most this share of the range of the labels. Where actions are
                choices it only has to be smaller than their distance.
        """
        if not 0 <= tolerance < 1:
            raise ParameterError(f"tolerance is {tolerance}; wanted a share of the labels' range")
        self.embedding = embedding
        self.tolerance = tolerance

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read what the embedding reads."""
        return self.embedding.attach(policy)

    def fit(self, labels: NDArray, seen: Seen) -> Self:
        """Keep the vectors and labels of the policy's training states."""
        return self._take(self.embedding.fit(seen).transform(seen), np.asarray(labels))

    def alike(self, seen: Seen, place: int = 1) -> NDArray[np.float64]:
        """Return (n,) distances to the `place`-th nearest state with what is proposed as its label.

        Infinite where there are fewer; NaN where vector or proposal is not finite.
        """
        return self._nearest(seen, self._same(seen.actions), place)

    def unlike(self, seen: Seen) -> NDArray[np.float64]:
        """Return (n,) distances to the nearest state with any other label, as `alike`."""
        return self._nearest(seen, np.logical_not(self._same(seen.actions)), 1)

    def nearest(self, seen: Seen, count: int) -> Precedents | None:
        """Return the training states nearest to one state; None where it is not finite."""
        vectors = self.embedding.transform(seen)
        return nearest(vectors[0], self.vectors_, self.labels_, seen.actions[0], count)

    def arrays(self) -> Arrays:
        """The embedding's, the (m, d) vectors and the (m, a) labels."""
        learned = {"vectors": self.vectors_, "labels": self.labels_}
        return {**flatten({"embedding": self.embedding.arrays()}), **learned}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`; ParameterError where their shapes do not belong together."""
        self.embedding.load(subtree(arrays, "embedding"))
        vectors = numbers(arrays, "vectors", None, None)
        return self._take(vectors, numbers(arrays, "labels", len(vectors), None))

    def _take(self, vectors: NDArray, labels: NDArray) -> Self:
        self.vectors_ = np.asarray(vectors, np.float32)
        self.labels_ = np.asarray(labels, np.float32)
        # Expert's choices are few: a proposal is held against each once, not against every state.
        self._distinct, which = np.unique(self.labels_, axis=0, return_inverse=True)
        self._which = which.ravel()
        self._reach = self.tolerance * np.ptp(self.labels_, axis=0) + 1e-6
        if len(self._distinct) > MOST_CHOICES:
            self._rows = [rows_of(self.vectors_)]
        else:
            chosen = (self._which == each for each in range(len(self._distinct)))
            self._rows = [rows_of(self.vectors_[these]) for these in chosen]
        return self

    def _same(self, proposed: NDArray) -> NDArray[np.bool_]:
        """(n, distinct labels) whether the label counts as the proposal."""
        return (np.abs(proposed[:, None] - self._distinct) <= self._reach).all(axis=2)

    def _nearest(self, seen: Seen, asked: NDArray[np.bool_], place: int) -> NDArray[np.float64]:
        """(n,) distances to the `place`-th nearest state with a label that is `asked` for."""
        vectors = self.embedding.transform(seen)
        by_choice = len(self._distinct) <= MOST_CHOICES
        squares = (self._by_choice if by_choice else self._one_by_one)(vectors, asked, place)
        finite = np.isfinite(vectors).all(axis=1) & np.isfinite(seen.actions).all(axis=1)
        return np.where(finite, distances(squares), np.nan)

    def _by_choice(
        self, vectors: NDArray[np.float32], asked: NDArray[np.bool_], place: int
    ) -> NDArray[np.float32]:
        choices = np.flatnonzero(asked.any(axis=0))
        if len(vectors) == len(choices) == 1:
            # As in most steps of a robot, where masks would take longer than the product.
            return self._rows[choices[0]].nearest(vectors, place)[:, -1]
        found = np.full((len(vectors), place), np.float32(np.inf))
        for choice in choices:
            asking = asked[:, choice]
            nearest = self._rows[choice].nearest(vectors[asking], place)
            found[asking] = smallest(np.concatenate([found[asking], nearest], axis=1), place)
        return found[:, -1]

    def _one_by_one(
        self, vectors: NDArray[np.float32], asked: NDArray[np.bool_], place: int
    ) -> NDArray[np.float32]:
        found = np.full(len(vectors), np.float32(np.inf))
        for first in range(0, len(vectors) if len(self._which) >= place else 0, BATCH):
            some = slice(first, first + BATCH)
            squares = self._rows[0].squares(vectors[some])
            kept = np.where(asked[some].take(self._which, axis=1), squares, np.float32(np.inf))
            found[some] = smallest(kept, place)[:, -1]
        return found
