"""One embedding for all parts of a signal that look at states alike."""

import weakref
from collections.abc import Callable
from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Arrays, Embedding, PredictingPolicy, Reader
from sheath_manip.types.seen import Seen


@final
class SharedEmbedding:
    """An embedding that is fitted once to the same states, and transforms the same states once.

    Support and precedent often look at states alike, and whitening is most of what each costs.
    """

    def __init__(self, embedding: Embedding) -> None:
        self.embedding = embedding
        self._policy: PredictingPolicy | None = None
        self._forget()

    @property
    def uses_displaced(self) -> bool:
        """Whether the embedding's `fit` needs `Seen.displaced`."""
        return self.embedding.uses_displaced

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read what the embedding reads."""
        if policy is not self._policy:
            self._policy = policy
            self._forget()
        return self.embedding.attach(policy)

    def fit(self, seen: Seen) -> Self:
        """Fit the embedding, unless it is fitted to these very states already."""
        if _is(self._fitted_to, seen):
            return self
        self._forget()
        self.embedding.fit(seen)
        self._fitted_to = weakref.ref(seen)
        return self

    def transform(self, seen: Seen) -> NDArray[np.float32]:
        """(n, d) the embedding's vectors; of the states asked for last they are still known."""
        if not _is(self._transformed, seen):
            self._vectors = self.embedding.transform(seen)
            self._transformed = weakref.ref(seen)
        return self._vectors

    def arrays(self) -> Arrays:
        """Return the embedding's learned state."""
        return self.embedding.arrays()

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        self._forget()
        self.embedding.load(arrays)
        return self

    def _forget(self) -> None:
        # References that keep no states alive.
        self._fitted_to: weakref.ref[Seen] | None = None
        self._transformed: weakref.ref[Seen] | None = None
        self._vectors = np.empty((0, 0), np.float32)


def shared_by_name(make: Callable[[str], Embedding]) -> Callable[[str], Embedding]:
    """Return what makes embeddings as `make` does, but the same one for the same name."""
    made: dict[str, Embedding] = {}

    def embedding(name: str) -> Embedding:
        if name not in made:
            made[name] = SharedEmbedding(make(name))
        return made[name]

    return embedding


def _is(reference: weakref.ref[Seen] | None, seen: Seen) -> bool:
    return reference is not None and reference() is seen
