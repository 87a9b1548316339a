"""What is the same for all signals that measure one number, which is the score as it is."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import Reason
from sheath_manip.types.seen import Seen


class SingleMeasure(ABC):
    """A signal whose measure is its score, with nothing to learn from held-out episodes."""

    reason: ClassVar[Reason] = Reason.RISK
    """what is to blame for a low score"""

    @abstractmethod
    def score(self, seen: Seen) -> NDArray[np.float64]:
        """(n,) the score of each state; NaN where there is none."""

    def measure(self, seen: Seen) -> NDArray[np.float64]:
        """(n, 1) the scores."""
        return np.asarray(self.score(seen), np.float64)[:, None]

    def calibrate(self, measures: Sequence[NDArray]) -> Self:
        """A score that stands by itself needs no held-out states."""
        del measures
        return self

    def scores(self, measures: NDArray) -> NDArray[np.float64]:
        """(n,) the measure itself."""
        return measures[:, 0]

    def blames(self, measures: NDArray) -> Reason:
        """Return the one reason that there is."""
        del measures
        return self.reason
