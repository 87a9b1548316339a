"""How states become places in two dimensions: the task's plane, or a projection of what is seen."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.support.plane import BANDWIDTH_FACTOR
from sheath_manip.types import Observation, TaskSpec
from sheath_manip.types.samples import Samples

MOST_STATES = 4000
"""that axes are found from"""


class Chart(Protocol):
    """Places states."""

    title: str
    """what the two axes are"""
    bandwidth_factor: float
    """c of the kernel that the support is drawn with, in median squared distances"""

    def fit(self, states: Samples) -> NDArray[np.float64]:
        """(n, 2) the places of the training `states`."""
        ...

    def places(self, observations: Sequence[Observation]) -> NDArray[np.float64]:
        """Return the (m > 0, 2) places of observations; a projection has to be fitted first."""
        ...


class PlaneChart:
    """Two features, in metres."""

    bandwidth_factor = BANDWIDTH_FACTOR

    def __init__(self, spec: TaskSpec) -> None:
        """ParameterError where the task has no plane."""
        if spec.plane is None:
            raise ParameterError(f"{spec.name} has no natural plane; wanted a projection")
        self._columns = [spec.feature_names.index(name) for name in spec.plane]
        x, y = (name.removesuffix("_m") for name in spec.plane)
        self.title = f"over {x} and {y} (m)"

    def fit(self, states: Samples) -> NDArray[np.float64]:
        """(n, 2) metres."""
        return states.features[:, self._columns].astype(np.float64)

    def places(self, observations: Sequence[Observation]) -> NDArray[np.float64]:
        """(m, 2) metres."""
        return np.array([each.features[self._columns] for each in observations], np.float64)


class ProjectionChart:
    """The two directions in which the training states' features differ most (Pearson 1901).

    The features are scaled to variance 1 first, and those that never change are left out.
    """

    title = "features, projected to their two widest directions"
    # A cloud, which needs none of the sharpness of a road's edge.
    bandwidth_factor = 0.1

    def fit(self, states: Samples) -> NDArray[np.float64]:
        """(n, 2) places."""
        features = np.asarray(states.features, np.float64)
        step = -(-len(features) // MOST_STATES)
        sample = features[::step]
        self._mean, spread = sample.mean(axis=0), sample.std(axis=0)
        weights = np.divide(1.0, spread, out=np.zeros_like(spread), where=spread > 0)
        centred = (sample - self._mean) * weights
        # Of the covariance and not of the states, of which there may be many more.
        _, vectors = np.linalg.eigh(centred.T @ centred)
        self._axes = weights[:, None] * vectors[:, :-3:-1]
        return self._placed(features)

    def places(self, observations: Sequence[Observation]) -> NDArray[np.float64]:
        """(m, 2) places."""
        return self._placed(np.stack([each.features for each in observations]))

    def _placed(self, features: NDArray) -> NDArray[np.float64]:
        places = (features - self._mean) @ self._axes
        # Of fewer than two features there is no second direction.
        return np.pad(places, ((0, 0), (0, max(0, 2 - places.shape[1]))))


def chart_of(spec: TaskSpec) -> Chart:
    """The task's plane where it has one."""
    return ProjectionChart() if spec.plane is None else PlaneChart(spec)
