"""Concatenates several embeddings with fixed relative weights."""

from collections.abc import Mapping
from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.nested_arrays import flatten, subtree
from sheath_manip.policies.readings import each_once
from sheath_manip.protocols import Arrays, Embedding, PredictingPolicy, Reader
from sheath_manip.types.seen import Seen


@final
class SideBySide:
    """The parts' vectors one after the other, each in units of its own spread.

    Squared distances add up, so that without the units the part with the most numbers would decide
    alone. A part's spread is the mean squared distance of its training vectors from their mean.
    """

    def __init__(self, embeddings: Mapping[str, Embedding], weights: Mapping[str, float]) -> None:
        """Take the parts and, by the same names, what their squared distances count.

        ParameterError where the names differ or a weight is not positive.
        """
        if embeddings.keys() != weights.keys() or not all(w > 0 for w in weights.values()):
            raise ParameterError(
                f"got weights {dict(weights)} for embeddings {list(embeddings)}; "
                "wanted one above 0 for each"
            )
        self.embeddings = embeddings
        self.weights = weights

    @property
    def uses_displaced(self) -> bool:
        """Whether any part's `fit` needs `Seen.displaced`."""
        return any(embedding.uses_displaced for embedding in self.embeddings.values())

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read for every part; equal readers read once."""
        return each_once(
            reader for embedding in self.embeddings.values() for reader in embedding.attach(policy)
        )

    def fit(self, seen: Seen) -> Self:
        """Fit every part, and its unit, to the training states."""
        self.factors_ = {}
        for name, embedding in self.embeddings.items():
            vectors = embedding.fit(seen).transform(seen)
            spread = float(vectors.var(axis=0, dtype=np.float64).sum())
            # A part in which nothing moved has no unit, and no say in what is near.
            factor = np.sqrt(self.weights[name] / spread) if spread > 0 else 1.0
            self.factors_[name] = np.float32(factor)
        return self

    def transform(self, seen: Seen) -> NDArray[np.float32]:
        """(n, sum of the parts' numbers) vectors."""
        parts = [
            self.factors_[name] * embedding.transform(seen)
            for name, embedding in self.embeddings.items()
        ]
        return np.concatenate(parts, axis=1)

    def arrays(self) -> Arrays:
        """Return the arrays of each part, and the parts' factors."""
        learned = {name: embedding.arrays() for name, embedding in self.embeddings.items()}
        factors = {f"factor/{name}": np.array(factor) for name, factor in self.factors_.items()}
        return {**flatten(learned), **factors}

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        for name, embedding in self.embeddings.items():
            embedding.load(subtree(arrays, name))
        factors = subtree(arrays, "factor")
        self.factors_ = {name: np.float32(factors[name]) for name in self.embeddings}
        return self
