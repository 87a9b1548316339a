"""An embedding of what is seen from the tool."""

from collections.abc import Hashable
from typing import Self, final

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.egocentric import EgocentricPolicy
from sheath_manip.policies.embeddings import ScaledEmbedding
from sheath_manip.policies.readings import INSTEAD, SeenFromTool
from sheath_manip.protocols import Arrays, PredictingPolicy, Reader
from sheath_manip.types.seen import Seen


@final
class FromTool:
    """Another embedding, which is shown what the egocentric policy sees, and looks through it."""

    uses_displaced = False
    """what is displaced are whole images, from which a tool's view would be taken in turn"""

    def __init__(self, embedding: ScaledEmbedding) -> None:
        """Store the embedding; ParameterError for one that contrasts with displaced images."""
        if embedding.uses_displaced:
            raise ParameterError("a tool's view has no displaced images; wanted another scaling")
        self.embedding = embedding
        self._readers: tuple[Reader, ...] = ()

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read looks of `policy`; ParameterError where that is not egocentric."""
        if not isinstance(policy, EgocentricPolicy):
            raise ParameterError(
                "an embedding of what is seen from the tool needs the policy egocentric-cnn, "
                f"not {type(policy).__name__}; use {INSTEAD}"
            )
        inner = self.embedding.attach(policy.inner)
        self._readers = tuple(SeenFromTool(reader) for reader in inner)
        return self._readers

    def fit(self, seen: Seen) -> Self:
        """Fit to the training states."""
        self.embedding.fit(self._shown(seen))
        return self

    def transform(self, seen: Seen) -> NDArray[np.float32]:
        """(n, d) vectors."""
        return self.embedding.transform(self._shown(seen))

    def arrays(self) -> Arrays:
        """The other embedding's."""
        return self.embedding.arrays()

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()`."""
        self.embedding.load(arrays)
        return self

    def _shown(self, seen: Seen) -> Seen:
        """Look up readings as the other embedding does."""
        readings: dict[Hashable, NDArray] = {
            reader.reader: seen.readings[reader]
            for reader in self._readers
            if isinstance(reader, SeenFromTool)
        }
        return Seen(seen.features, seen.actions, readings)
