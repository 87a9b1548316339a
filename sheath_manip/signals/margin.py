"""How sure the policy is: by how much its choice beats the second best.

Where two actions score nearly alike, a state hardly different would have been labelled otherwise,
or the labels contradict each other and the policy took the middle.
"""

from collections.abc import Mapping, Sequence
from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Agreement, Arrays, Policy, ScoresChoices
from sheath_manip.types.samples import Samples


class MarginSignal:
    """The best choice's score less the second best's, in the policy's own units.

    Alone it knows nothing of leaving the support: far from all it learned a policy may be sure.
    """

    def fit(self, policy: Policy, states: Samples, agreement: Agreement | None = None) -> Self:
        """Look at `policy`; ParameterError for one that does not score its choices."""
        del states, agreement
        return self._look_at(policy)

    def calibrate(self, episodes: Sequence[Samples]) -> Self:
        """A margin needs no held-out states."""
        del episodes
        return self

    def scores(
        self, images: Mapping[str, NDArray[np.uint8]], features: NDArray
    ) -> NDArray[np.float64]:
        """(n,) at least 0; inf where no other choice was ever asked for."""
        scores = self.policy.choice_scores(images, features).astype(np.float64)
        best = np.partition(scores, -2, axis=1)
        return best[:, -1] - best[:, -2]

    def arrays(self) -> Arrays:
        """None: all that it knows is the policy's."""
        return {}

    def load(self, policy: Policy, arrays: Arrays) -> Self:
        """Look at `policy`."""
        del arrays
        return self._look_at(policy)

    def _look_at(self, policy: Policy) -> Self:
        if not isinstance(policy, ScoresChoices):
            raise ParameterError(
                f"{type(policy).__name__} does not score its choices; wanted a policy with "
                "choice_scores(), like linear-svm or cnn, or a signal without a margin"
            )
        self.policy = policy
        return self
