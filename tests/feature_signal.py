"""A signal for tests of what is made of signals."""

from typing import Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Agreement, Arrays, PredictingPolicy, Reader
from sheath_manip.signals.single import SingleMeasure
from sheath_manip.types import Reason
from sheath_manip.types.seen import Seen


class FeatureSignal(SingleMeasure):
    """Its score is a feature."""

    uses_displaced = False

    def __init__(self, column: int, reason: Reason = Reason.RISK) -> None:
        self.column = column
        self._reason = reason

    def attach(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        del policy
        return ()

    def fit(self, labels: NDArray, seen: Seen, agreement: Agreement | None = None) -> Self:
        del labels, seen, agreement
        return self

    def score(self, seen: Seen) -> NDArray[np.float64]:
        return np.asarray(seen.features)[:, self.column].astype(float)

    def blames(self, measures: NDArray) -> Reason:
        del measures
        return self._reason

    def arrays(self) -> Arrays:
        return {}

    def load(self, arrays: Arrays) -> Self:
        del arrays
        return self
