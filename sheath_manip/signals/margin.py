"""How sure the policy is: by how much its choice beats the second best.

Where two actions score nearly alike, a state hardly different would have been labelled otherwise,
or the labels contradict each other and the policy took the middle.
"""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.readings import Latent
from sheath_manip.protocols import Agreement, Arrays, PredictingPolicy, Reader
from sheath_manip.signals.single import SingleMeasure
from sheath_manip.types.seen import Seen

CHOICE_SCORES = Latent("choice scores")


class MarginSignal(SingleMeasure):
    """The best choice's score less the second best's, in the policy's own units.

    Alone it knows nothing of leaving the support: far from all it learned a policy may be sure.
    """

    uses_displaced = False

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """Read how the policy ranks its choices."""
        del policy
        return (CHOICE_SCORES,)

    def fit(self, labels: NDArray, seen: Seen, agreement: Agreement | None = None) -> Self:
        """Return self: there is nothing to fit."""
        del labels, seen, agreement
        return self

    def score(self, seen: Seen) -> NDArray[np.float64]:
        """Return (n,) margins of at least 0; inf where no other choice was ever asked for."""
        scores = seen.of((CHOICE_SCORES,)).astype(np.float64)
        best = np.partition(scores, -2, axis=1)
        return best[:, -1] - best[:, -2]

    def arrays(self) -> Arrays:
        """Return no arrays, since nothing is learned: all that it knows is the policy's."""
        return {}

    def load(self, arrays: Arrays) -> Self:
        """Do nothing: there is nothing to take over."""
        del arrays
        return self
