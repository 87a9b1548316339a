"""A signal for tests of what is made of signals."""

from typing import Self

import numpy as np
from numpy.typing import NDArray


class FeatureSignal:
    """Its score is a feature."""

    def __init__(self, column: int) -> None:
        self.column = column

    def calibrate(self, episodes) -> Self:
        del episodes
        return self

    def scores(self, images, features) -> NDArray[np.float64]:
        del images
        return np.asarray(features)[:, self.column].astype(float)
