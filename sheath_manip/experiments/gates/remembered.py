"""An embedding fitted once, and its vectors computed once, for all gates that look through it."""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies import make_embedding
from sheath_manip.protocols import Arrays, Embedding, PredictingPolicy, Reader, Signal
from sheath_manip.signals import SignalChoice, make_signal
from sheath_manip.types.seen import Seen


class Remembered:
    """An embedding that is fitted to the same looks, and scales the same readings, only once."""

    def __init__(self, embedding: Embedding) -> None:
        self.embedding = embedding
        self._fitted_to: Seen | None = None
        self._vectors: dict[int, tuple[Seen, NDArray[np.float32]]] = {}
        """by the identity of what was seen, which is held as long"""

    @property
    def uses_displaced(self) -> bool:
        """Whether the embedding's `fit` needs `Seen.displaced`."""
        return self.embedding.uses_displaced

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read what the embedding reads."""
        return self.embedding.attach(policy)

    def fit(self, seen: Seen) -> Self:
        """Fit, unless it is fitted to just this."""
        if self._fitted_to is not seen:
            self.embedding.fit(seen)
            self._fitted_to = seen
            self._vectors.clear()
        return self

    def transform(self, seen: Seen) -> NDArray[np.float32]:
        """(n, d) the embedding's vectors."""
        if id(seen) not in self._vectors:
            self._vectors[id(seen)] = seen, self.embedding.transform(seen)
        return self._vectors[id(seen)][1]

    def arrays(self) -> Arrays:
        """The embedding's."""
        return self.embedding.arrays()

    def load(self, arrays: Arrays) -> Self:
        """Take over an embedding's state and forget."""
        self.embedding.load(arrays)
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
