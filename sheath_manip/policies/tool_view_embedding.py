"""An embedding of what is seen from the tool."""

from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.egocentric import EgocentricPolicy
from sheath_manip.policies.embeddings import Images
from sheath_manip.protocols import Arrays, Embedding, Policy
from sheath_manip.types.samples import Samples


@final
class SeenFromTool:
    """Another embedding, which is shown what the egocentric policy sees, and looks through it."""

    def __init__(self, embedding: Embedding) -> None:
        self.embedding = embedding

    def fit(self, policy: Policy, samples: Samples) -> Self:
        """Fit to the training states of `policy`; ParameterError where that is not egocentric."""
        self.policy = _egocentric(policy)
        self.embedding.fit(self.policy.seeing, self.policy.view.samples(samples))
        return self

    def transform(self, images: Images, features: NDArray) -> NDArray[np.float32]:
        """(n, d) for (n, h, w, 3) images by camera and (n, f) features."""
        view = self.policy.view
        camera = view.frame.camera
        seen = {camera: view.images(images[camera], features)}
        return self.embedding.transform(seen, view.features(features))

    def arrays(self) -> Arrays:
        """The other embedding's."""
        return self.embedding.arrays()

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Take over `arrays()` on top of `policy`."""
        self.policy = _egocentric(policy)
        self.embedding.load(self.policy.seeing, arrays)
        return self


def _egocentric(policy: Policy) -> EgocentricPolicy:
    if not isinstance(policy, EgocentricPolicy):
        raise ParameterError(
            "an embedding of what is seen from the tool needs the policy egocentric-cnn, "
            f"not {type(policy).__name__}; use the embedding 'pixels'"
        )
    return policy
