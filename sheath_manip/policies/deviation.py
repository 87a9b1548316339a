"""How far continuous actions are apart, as the surrogate loss of policies that regress them."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import ActionSpec


def largest_deviations(
    action: ActionSpec, predicted: NDArray, labels: NDArray
) -> NDArray[np.float32]:
    """Return (n,) in 0..1: how far (n, a) predictions are from labels in the worst dimension.

    As a share of the dimension's range, so that units do not matter; the worst one, since a robot
    that is right in six dimensions and wrong in the seventh is wrong.
    """
    shares = np.abs(predicted - labels) / action.span
    return np.clip(shares.max(axis=1), 0.0, 1.0).astype(np.float32)
