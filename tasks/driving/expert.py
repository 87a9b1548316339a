"""The driving expert: search over steering sequences through the car's own dynamics."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.sequence_search import SequenceSearch
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.task import CONTROL_TIMESTEP_S, SPEED_M_S, DrivingTask
from sheath_manip.types import Action, Observation

# Two cars of 2.0 x 1.0 m touch when they are this far apart along and across, if parallel.
_TOUCH_ALONG_M, _TOUCH_ACROSS_M = 2.0, 1.0
_CLEARANCE_M = 0.9
"""around a car, wanted but not required"""
_EDGE_M = 1.0
"""of road at each side, avoided but not forbidden"""
_CRASH = 1000.0
_DISCOUNT = 0.95
"""of a crash, a step: where one cannot be avoided the later one is the better"""


class DrivingExpert:
    """Sees the traffic's true poses and plans 12 steps ahead, from any state."""

    def __init__(self, environment: ComposerEnvironment) -> None:
        if not isinstance(environment.task, DrivingTask):
            raise TypeError(f"DrivingExpert wants a DrivingTask, got {environment.task!r}")
        self._environment = environment
        self._task = environment.task
        choices = self._task.spec.action.choices
        assert choices is not None
        self._choices = choices
        self._search = SequenceSearch(choices, segment_steps=(1, 1, 2, 3, 5))

    def reset(self) -> None:
        """Do nothing: nothing is remembered between steps."""

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """(1,) steering angle, rad."""
        return self._search.best_first_action(self._cost)

    def regrets(self) -> NDArray[np.float64]:
        """(3,) for each steering choice, how much dearer its best sequence is than the best."""
        costs = self._search.costs_of_first_actions(self._cost)
        return costs - costs.min()

    def choice_of(self, action: Action) -> int:
        """Which of the steering choices `action` (1,) is nearest to: the index into `regrets()`."""
        return int(np.argmin(np.abs(self._choices - action).sum(axis=1)))

    def _cost(self, sequences: NDArray[np.float64]) -> NDArray[np.float64]:
        """(n,) cost of (n, horizon, 1) steering sequences from the present state."""
        physics = self._environment.physics
        x0, y0, heading0 = self._task.pose(physics)
        headings = heading0 + np.cumsum(sequences[:, :, 0], axis=1)
        step_m = SPEED_M_S * CONTROL_TIMESTEP_S
        x = x0 + step_m * np.cumsum(np.cos(headings), axis=1)
        y = y0 + step_m * np.cumsum(np.sin(headings), axis=1)
        horizon = sequences.shape[1]

        track = self._task.track
        _, lateral, road = track.coordinates(x, y)
        turned = np.angle(np.exp(1j * (headings - road)))
        over = np.abs(lateral) - (track.road_half_width - _EDGE_M)
        comfort = 0.05 * lateral**2 + 2.0 * (1 - np.cos(turned)) + 4.0 * np.maximum(over, 0.0) ** 2
        crash = over > _EDGE_M - 0.1

        times = physics.time() + CONTROL_TIMESTEP_S * np.arange(1, horizon + 1)
        traffic = self._task.traffic_poses(times)
        dx = x[:, :, None] - traffic[None, :, :, 0]
        dy = y[:, :, None] - traffic[None, :, :, 1]
        cos, sin = np.cos(traffic[None, :, :, 2]), np.sin(traffic[None, :, :, 2])
        # A car that is turned against the other one is wider across it.
        skew = np.abs(np.sin(headings[:, :, None] - traffic[None, :, :, 2]))
        along = np.abs(cos * dx + sin * dy) - _TOUCH_ALONG_M
        across = np.abs(cos * dy - sin * dx) - (_TOUCH_ACROSS_M + 0.6 * skew)
        gap = np.maximum(along, across)
        crash = crash | (gap < 0.15).any(axis=2)
        near = np.maximum(_CLEARANCE_M - gap, 0.0) ** 2
        comfort = comfort + 6.0 * near.max(axis=2, initial=0.0)

        first_crash = np.where(crash.any(axis=1), crash.argmax(axis=1), horizon)
        crash_cost = np.where(first_crash < horizon, _CRASH * _DISCOUNT**first_crash, 0.0)
        effort = 0.02 * np.abs(sequences[:, :, 0]).sum(axis=1)
        return comfort.sum(axis=1) + crash_cost + effort
