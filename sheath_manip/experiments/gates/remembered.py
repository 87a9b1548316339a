"""An embedding's vectors, computed once for all estimators that look at the same states."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.checkpoint import Checkpoint
from sheath_manip.dataset.samples import Samples
from sheath_manip.protocols import Arrays, Embedding, Policy

Vectors = dict[tuple[int, ...], NDArray[np.float32]]
"""by the images that they are of, which must be kept as long"""


class Remembered:
    """A fitted embedding that looks at the same images only once.

    Gates whose embedding is of the same kind and was fitted on the same policy and states may share
    `vectors`.
    """

    def __init__(self, embedding: Embedding, vectors: Vectors) -> None:
        self.embedding = embedding
        self.vectors = vectors

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """Fit anew and forget."""
        self.embedding.fit(policy, samples)
        self.vectors.clear()
        return self

    def transform(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float32]:
        """(n, d) the embedding's vectors."""
        key = (*(id(array) for array in images.values()), id(features))
        if key not in self.vectors:
            self.vectors[key] = self.embedding.transform(images, features)
        return self.vectors[key]

    def arrays(self) -> Arrays:
        """The embedding's."""
        return self.embedding.arrays()

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over an embedding's state and forget."""
        self.embedding.load(policy, arrays)
        self.vectors.clear()
        return self


def remembering(checkpoint: Checkpoint, vectors: Vectors) -> Checkpoint:
    """`checkpoint`, whose embedding puts into `vectors` what is not there yet."""
    return replace(checkpoint, embedding=Remembered(checkpoint.embedding, vectors))
