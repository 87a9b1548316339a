"""An embedding fitted once, and its vectors computed once, for all gates that look through it."""

from collections.abc import Mapping
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies import make_embedding
from sheath_manip.protocols import Arrays, Embedding, Policy, Signal
from sheath_manip.signals import SignalChoice, make_signal
from sheath_manip.types.samples import Samples


class Remembered:
    """An embedding that is fitted to the same states, and looks at the same images, only once.

    The samples that it has seen must be kept as long: it knows them by identity.
    """

    def __init__(self, embedding: Embedding) -> None:
        self.embedding = embedding
        self._fitted_to: tuple[Policy, Samples] | None = None
        self._vectors: dict[tuple[int, ...], NDArray[np.float32]] = {}

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """Fit, unless it is fitted to just these."""
        if self._fitted_to is None or any(
            held is not given
            for held, given in zip(self._fitted_to, (policy, samples), strict=True)
        ):
            self.embedding.fit(policy, samples)
            self._fitted_to = policy, samples
            self._vectors.clear()
        return self

    def transform(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float32]:
        """(n, d) the embedding's vectors."""
        key = (*(id(array) for array in images.values()), id(features))
        if key not in self._vectors:
            self._vectors[key] = self.embedding.transform(images, features)
        return self._vectors[key]

    def arrays(self) -> Arrays:
        """The embedding's."""
        return self.embedding.arrays()

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over an embedding's state and forget."""
        self.embedding.load(policy, arrays)
        self._fitted_to = None
        self._vectors.clear()
        return self


class Shared:
    """Makes signals that have their embeddings in common."""

    def __init__(self) -> None:
        self._embeddings: dict[str, Remembered] = {}

    def signal(self, choice: SignalChoice) -> Signal:
        """A fresh signal of `choice` on shared embeddings."""
        return make_signal(choice, self._embedding)

    def _embedding(self, name: str) -> Remembered:
        if name not in self._embeddings:
            self._embeddings[name] = Remembered(make_embedding(name))
        return self._embeddings[name]
