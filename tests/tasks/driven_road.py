"""The driving task on roads to be driven; most have a tiny picture, since few tests look at it."""

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.task import (
    CONTROL_TIMESTEP_S,
    SPEED_M_S,
    STEERING_RAD,
    DrivingTask,
    Scenario,
)
from sheath_manip.types import Observation, Transition

LEFT, AHEAD, RIGHT = (np.array([turn], np.float32) for turn in (STEERING_RAD, 0, -STEERING_RAD))
STEP_M = SPEED_M_S * CONTROL_TIMESTEP_S


class Road:
    """An environment with its task, under names of their own types."""

    def __init__(self, scenario: Scenario) -> None:
        self.task = DrivingTask(scenario)
        self.environment = ComposerEnvironment(self.task)

    def put(self, s_m: float, lateral_m: float, turned_rad: float = 0.0) -> None:
        """Put the car onto the road in an episode that has begun, the others far off."""
        away = np.full(self.task.scenario.cars, -500.0)
        self.environment.reset(0)
        self.task.set_traffic(self.environment.physics, np.stack([np.zeros_like(away), away], 1))
        pose = self.task.track.pose(np.array(s_m), np.array(lateral_m))
        self.task.place(self.environment.physics, pose + np.array([0, 0, turned_rad]))
        self.environment.physics.forward()

    def drive(self, actions: Sequence[np.ndarray]) -> list[Transition]:
        """Up to the end of the episode."""
        transitions = []
        for action in actions:
            transitions.append(self.environment.step(action))
            if transitions[-1].terminated or transitions[-1].truncated:
                break
        return transitions


def made(scenario: Scenario) -> Iterator[Road]:
    road = Road(scenario)
    yield road
    road.environment.close()


@pytest.fixture(scope="module")
def road() -> Iterator[Road]:
    """With the pictures of the task's default."""
    yield from made(Scenario())


@pytest.fixture(scope="module")
def small() -> Iterator[Road]:
    """A few cars and a tiny picture."""
    yield from made(Scenario(cars=3, render_px=16, pyramid_levels=1))


@pytest.fixture(scope="module")
def empty() -> Iterator[Road]:
    """No other car, three laps."""
    yield from made(Scenario(laps=3.0, cars=0, render_px=16, pyramid_levels=1))


def assert_same(first: Observation, second: Observation) -> None:
    np.testing.assert_array_equal(first.images["overhead"], second.images["overhead"])
    np.testing.assert_array_equal(first.features, second.features)
    assert first.time_s == second.time_s


def wiggle(count: int) -> list[np.ndarray]:
    rng = np.random.default_rng(1)
    turns = rng.permutation([*[1, -1] * (count // 4), *[0] * (count - count // 4 * 2)])
    return [np.array([turn * STEERING_RAD], np.float32) for turn in turns]
