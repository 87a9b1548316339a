"""Who does not look while cutting: to compare with."""

from collections.abc import Callable

import numpy as np

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.cutting.locating import Lie
from sheath_manip.tasks.gauze_cutting.expert import task_of
from sheath_manip.tasks.gauze_cutting.geometry import CENTRE_M, MESH
from sheath_manip.tasks.gauze_cutting.guide import along_circle
from sheath_manip.tasks.gauze_cutting.task import GauzeTask
from sheath_manip.types import Action, Observation

_EVERYWHERE_M = 1.0


class OpenLoop:
    """Follows the circle in the sheet as it takes it to lie, and believes to be in it."""

    def __init__(
        self, environment: ComposerEnvironment, believed: Callable[[GauzeTask], Lie]
    ) -> None:
        self._task = task_of(environment)
        self._believed = believed
        self._lie: Lie | None = None

    def reset(self) -> None:
        """Look once."""
        self._lie = self._believed(self._task)

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """Return (2,) as the task's action spec has it."""
        if self._lie is None:
            self.reset()
        assert self._lie is not None
        task = self._task
        place = self._lie.below(task.tip_m[:2], np.zeros(2), _EVERYWHERE_M)
        velocity = task.tip_velocity_m_s[:2]
        wanted = along_circle(self._lie, place.material_m, velocity, np.zeros(2))
        return task.scenario.steering.action_for(wanted, task.heading)


def nominal(task: GauzeTask) -> Lie:  # noqa: ARG001
    """The sheet with nothing out of place."""
    flat = np.column_stack([MESH.points_m, np.zeros(len(MESH.points_m))])
    return Lie(MESH.triangles, MESH.points_m, CENTRE_M + flat)


def blind(environment: ComposerEnvironment) -> OpenLoop:
    """Cut along the circle where it would be with nothing out of place."""
    return OpenLoop(environment, nominal)


def registered(environment: ComposerEnvironment) -> OpenLoop:
    """Cut along the circle where it lies when the episode starts."""
    return OpenLoop(environment, lambda task: task.workpiece.lie().copy())
