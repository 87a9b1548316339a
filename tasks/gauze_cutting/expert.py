"""The scripted expert: follows the circle as the deformed sheet shows it, from any state."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.guide import along_circle
from sheath_manip.tasks.gauze_cutting.task import GauzeTask
from sheath_manip.types import Action, Observation


def task_of(environment: ComposerEnvironment) -> GauzeTask:
    """The environment's task; TypeError where it is another's."""
    if not isinstance(environment.task, GauzeTask):
        raise TypeError(f"wanted the environment of a GauzeTask, got {environment.task!r}")
    return environment.task


class GauzeExpert:
    """Sees the mesh, and how fast it and the blade move. It remembers nothing."""

    def __init__(self, environment: ComposerEnvironment) -> None:
        self.task = task_of(environment)

    def reset(self) -> None:
        """Do nothing: there is nothing to forget."""

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """Return (2,) as the task's action spec has it."""
        return self.task.scenario.steering.action_for(self.velocity_m_s(), self.task.heading)

    def velocity_m_s(self) -> NDArray[np.float64]:
        """(2,) that it asks for now, world frame."""
        task = self.task
        lie = task.workpiece.lie()
        place = task.knife.place(lie, task.tip_m)
        drift = task.workpiece.velocity_m_s(place.corners)[:2]
        return along_circle(lie, place.material_m, task.tip_velocity_m_s[:2], drift)
