"""Whether the expert has done, in such a state, what the policy is about to do.

The support says that a state is familiar. A policy may err there all the same: where the states
like it got other labels. So the distance is taken to the nearest training state in which the expert
did what the policy proposes: nearest neighbours (Knox & Ng 1998) of state AND action.
"""

from collections.abc import Mapping, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.samples import Samples
from sheath_manip.exceptions import ParameterError
from sheath_manip.parts import part, prefixed
from sheath_manip.protocols import Agreement, Arrays, Embedding, Policy

# Rows compared at once: with 10,000 training states their distances take 40 MB.
BATCH = 1024


class PrecedentSignal:
    """Minus the distance to the nearest training state with the proposed action as its label."""

    def __init__(self, embedding: Embedding, tolerance: float = 0.1) -> None:
        """Store the hyperparameters; ParameterError for a tolerance outside 0..1.

        Args:
            embedding: in whose vectors the distance is taken.
            tolerance: in 0..1; labels and proposals count as the same action where they differ, in
                each dimension, by at most this share of the range of the labels. Where actions are
                choices it only has to be smaller than their distance.
        """
        if not 0 <= tolerance < 1:
            raise ParameterError(f"tolerance is {tolerance}; wanted a share of the labels' range")
        self.embedding = embedding
        self.tolerance = tolerance

    def fit(self, policy: Policy, states: Samples, agreement: Agreement | None = None) -> Self:
        """Keep the vectors and labels of the policy's training `states`."""
        del agreement
        self.policy = policy
        self.embedding.fit(policy, states)
        return self._take(
            self.embedding.transform(states.images, states.features), np.asarray(states.labels)
        )

    def calibrate(self, episodes: Sequence[Samples]) -> Self:
        """A distance needs no held-out states."""
        del episodes
        return self

    def scores(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float64]:
        """(n,) minus the distance: 0 on a training state, -inf without any precedent."""
        vectors = self.embedding.transform(images, features)
        proposed = self.policy.predict(images, features)
        parts = [
            self._batch(vectors[first : first + BATCH], proposed[first : first + BATCH])
            for first in range(0, len(vectors), BATCH)
        ]
        return np.concatenate(parts) if parts else np.empty(0)

    def arrays(self) -> Arrays:
        """The embedding's, the (n, d) vectors and the (n, a) labels."""
        learned = {"vectors": self.vectors_, "labels": self.labels_}
        return {**prefixed({"embedding": self.embedding.arrays()}), **learned}

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over `arrays()` on top of `policy`."""
        self.policy = policy
        self.embedding.load(policy, part(arrays, "embedding"))
        return self._take(arrays["vectors"], arrays["labels"])

    def _take(self, vectors: NDArray, labels: NDArray) -> Self:
        self.vectors_ = np.asarray(vectors, np.float32)
        self.labels_ = np.asarray(labels, np.float32)
        self._squares = np.einsum("nd,nd->n", self.vectors_, self.vectors_)
        self._reach = self.tolerance * np.ptp(self.labels_, axis=0) + 1e-6
        return self

    def _batch(self, vectors: NDArray[np.float32], proposed: NDArray) -> NDArray[np.float64]:
        # What is common to a row's distances, its own square, is added after the search.
        apart = self._squares - 2 * (vectors @ self.vectors_.T)
        same = (np.abs(proposed[:, None] - self.labels_) <= self._reach).all(axis=2)
        nearest = np.where(same, apart, np.inf).min(axis=1)
        distances = np.sqrt(np.maximum(nearest + np.einsum("nd,nd->n", vectors, vectors), 0))
        broken = ~(np.isfinite(vectors).all(axis=1) & np.isfinite(proposed).all(axis=1))
        return np.where(broken, np.nan, -distances.astype(np.float64))
