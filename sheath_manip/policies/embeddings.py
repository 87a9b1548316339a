"""The vectors on which the support is estimated: raw ones, and a scaling fitted to them."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.cnn import INFERENCE_BATCH
from sheath_manip.policies.displacement import displaced
from sheath_manip.policies.scaling import Scaling, Standardisation
from sheath_manip.protocols import Arrays, Policy
from sheath_manip.seeding import generator
from sheath_manip.types.samples import Samples

Images = Mapping[str, NDArray[np.uint8]]

# More displaced images tell no more, and cost a second a thousand.
MOST_DISPLACED = 3000


class ScaledEmbedding(ABC):
    """Raw vectors and the scaling fitted to them.

    It looks through the policy it was fitted on: after the policy's next fit, fit it again.
    """

    def __init__(self, scaling: Scaling | None = None) -> None:
        self.scaling: Scaling = Standardisation() if scaling is None else scaling

    @abstractmethod
    def attach(self, policy: Policy) -> None:
        """Look through `policy` from now on; ParameterError where it lacks what is needed."""

    @abstractmethod
    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, d) raw vectors of at most `INFERENCE_BATCH` images by camera."""

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """Fit the scaling to the training states of `policy`, and to displaced ones if it asks."""
        self.attach(policy)
        vectors = self._all_vectors(samples.images)
        if self.scaling.uses_displaced:
            count = min(MOST_DISPLACED, 2 * len(samples))
            elsewhere = displaced(samples.images, generator("displaced images"), count)
            self.scaling.fit(vectors, self._all_vectors(elsewhere))
        else:
            self.scaling.fit(vectors)
        return self

    def transform(self, images: Images, features: NDArray) -> NDArray[np.float32]:
        """(n, k) scaled vectors for (n, h, w, 3) images by camera; the features go unused."""
        del features
        return self.scaling.transform(self._all_vectors(images))

    def arrays(self) -> Arrays:
        """The scaling's learned state."""
        return self.scaling.arrays()

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over `arrays()` on top of `policy`."""
        self.attach(policy)
        self.scaling.load(arrays)
        return self

    def _all_vectors(self, images: Images) -> NDArray[np.float32]:
        count = len(next(iter(images.values())))
        if count <= INFERENCE_BATCH:
            return self.vectors(images)
        return np.concatenate(
            [
                self.vectors(
                    {camera: array[i : i + INFERENCE_BATCH] for camera, array in images.items()}
                )
                for i in range(0, count, INFERENCE_BATCH)
            ]
        )
