"""The policy's training states with their labels, and how far off they are from new ones."""

from collections.abc import Iterator
from typing import NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.learned_arrays import numbers
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.protocols import Arrays, Embedding, PredictingPolicy, Reader
from sheath_manip.signals.nearest import nearest
from sheath_manip.types.seen import Precedents, Seen

# Rows compared at once: with 10,000 training states their distances take 40 MB.
BATCH = 1024


class Compared(NamedTuple):
    """Some of the new states, and all m training states."""

    squares: NDArray[np.float32]
    """(n, m) of their distances in the embedding; rounding may leave one a little below 0"""
    same: NDArray[np.bool_]
    """(n, m) whether the training state's label is what the policy proposes in the new one"""
    broken: NDArray[np.bool_]
    """(n,) where vector or proposal is not finite: nothing can be said"""


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

    def compared(self, seen: Seen) -> Iterator[Compared]:
        """Compare all new states in turn, as many at once as memory likes."""
        vectors = self.embedding.transform(seen)
        for first in range(0, len(vectors), BATCH):
            rows = slice(first, first + BATCH)
            yield self._batch(vectors[rows], seen.actions[rows])

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
        self._squares = np.einsum("nd,nd->n", self.vectors_, self.vectors_)
        # Expert's choices are few: a proposal is held against each once, not against every state.
        self._distinct, self._which = np.unique(self.labels_, axis=0, return_inverse=True)
        self._reach = self.tolerance * np.ptp(self.labels_, axis=0) + 1e-6
        return self

    def _batch(self, vectors: NDArray[np.float32], proposed: NDArray) -> Compared:
        squares = self._squares - 2 * (vectors @ self.vectors_.T)
        squares += np.einsum("nd,nd->n", vectors, vectors)[:, None]
        alike = (np.abs(proposed[:, None] - self._distinct) <= self._reach).all(axis=2)
        same = alike.take(self._which, axis=1)
        finite = np.isfinite(vectors).all(axis=1) & np.isfinite(proposed).all(axis=1)
        return Compared(squares, same, np.logical_not(finite))


def distances(squares: NDArray[np.float32]) -> NDArray[np.float64]:
    """Return the distances, roots of the squared ones."""
    return np.sqrt(np.maximum(squares, 0)).astype(np.float64)
