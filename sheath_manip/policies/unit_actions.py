"""Continuous actions in -1..1 between their bounds, as networks regress them."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.types import ActionSpec


def to_unit(action: ActionSpec, actions: NDArray) -> NDArray[np.float32]:
    """(..., a) from the units of the action to -1..1 between its bounds."""
    return ((2 * actions - action.minimum - action.maximum) / action.span).astype(np.float32)


def from_unit(action: ActionSpec, outputs: NDArray[np.float32]) -> NDArray[np.float32]:
    """(..., a) from -1..1 back to the units of the action, cut to its bounds."""
    low, high = action.minimum, action.maximum
    actions = (low + high + outputs * action.span) / 2
    return np.clip(actions, low, high).astype(np.float32)
