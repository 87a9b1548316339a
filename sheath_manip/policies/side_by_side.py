"""Several embeddings as one: what each sees, side by side, no one louder than it is meant to be."""

from collections.abc import Mapping
from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.nested_arrays import part, prefixed
from sheath_manip.policies.embeddings import Images
from sheath_manip.protocols import Arrays, Embedding, Policy
from sheath_manip.types.samples import Samples


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

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """Fit every part, and its unit, to the training states of `policy`."""
        self.factors_ = {}
        for name, embedding in self.embeddings.items():
            embedding.fit(policy, samples)
            vectors = embedding.transform(samples.images, samples.features)
            spread = float(vectors.var(axis=0, dtype=np.float64).sum())
            # A part in which nothing moved has no unit, and no say in what is near.
            factor = np.sqrt(self.weights[name] / spread) if spread > 0 else 1.0
            self.factors_[name] = np.float32(factor)
        return self

    def transform(self, images: Images, features: NDArray) -> NDArray[np.float32]:
        """(n, sum of the parts' numbers) for (n, h, w, 3) images by camera and (n, f) features."""
        parts = [
            self.factors_[name] * embedding.transform(images, features)
            for name, embedding in self.embeddings.items()
        ]
        return np.concatenate(parts, axis=1)

    def arrays(self) -> Arrays:
        """Those of each part, and the parts' factors."""
        learned = {name: embedding.arrays() for name, embedding in self.embeddings.items()}
        factors = {f"factor/{name}": np.array(factor) for name, factor in self.factors_.items()}
        return {**prefixed(learned), **factors}

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over `arrays()` on top of `policy`."""
        for name, embedding in self.embeddings.items():
            embedding.load(policy, part(arrays, name))
        factors = part(arrays, "factor")
        self.factors_ = {name: np.float32(factors[name]) for name in self.embeddings}
        return self
