"""The scripted expert: the grasp law on what the physics shows."""

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.grasp_state import Intent
from sheath_manip.tasks.grasp_clutter.guide import GraspGuide
from sheath_manip.tasks.grasp_clutter.task import CONTROL_TIMESTEP_S, GraspTask
from sheath_manip.types import Action, Observation


class GraspExpert:
    """Sees the true poses, and knows what to do from any state of them."""

    def __init__(self, environment: ComposerEnvironment) -> None:
        if not isinstance(environment.task, GraspTask):
            raise TypeError(f"GraspExpert wants a GraspTask, got {environment.task!r}")
        self.environment = environment
        self._task = environment.task
        self._guide = GraspGuide(self._task.scenario.robot, CONTROL_TIMESTEP_S)
        self._scene = None
        self.intent = Intent.TRANSIT
        """what the last action stands for"""

    def reset(self) -> None:
        """Take over the shapes of the episode's objects."""
        self._scene = self._task.scene
        self._guide.begin(self._scene)

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """Return (7,) as the task's action spec has it."""
        if self._scene is not self._task.scene:
            self.reset()
        situation = self._task.situation(self.environment.physics)
        action, command = self._guide.action(situation)
        self.intent = command.intent
        return action
