"""Gauze cutting without cameras, with the expert that cuts."""

from collections.abc import Iterator

import mujoco
import numpy as np
import pytest

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.expert import GauzeExpert
from sheath_manip.tasks.gauze_cutting.scenario import Scenario
from sheath_manip.tasks.gauze_cutting.scene import CALM
from sheath_manip.tasks.gauze_cutting.task import GauzeTask

SEED = 20
"""of no experiment"""


class Bench:
    """An environment without cameras, its task, and its expert."""

    def __init__(self) -> None:
        self.task = GauzeTask(Scenario(cameras=(), difficulty=CALM))
        self.environment = ComposerEnvironment(self.task)
        self.expert = GauzeExpert(self.environment)

    def steps(self, count: int, action: np.ndarray | None = None) -> None:
        """By the expert, or one action all the time; ends with the episode."""
        for _ in range(count):
            chosen = self.expert.act(self.environment.observe()) if action is None else action
            if self.environment.step(chosen).terminated:
                return

    @property
    def data(self) -> mujoco.MjData:
        return self.environment.physics.data.ptr

    @property
    def model(self) -> mujoco.MjModel:
        return self.environment.physics.model.ptr


@pytest.fixture(scope="module")
def bench() -> Iterator[Bench]:
    made = Bench()
    yield made
    made.environment.close()
