"""The platformer's expert: an A* planner, as the draft's (section V-A), that keeps to its plans."""

import numpy as np

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.game import Buttons, Moment
from sheath_manip.tasks.platformer.planner import ACTIONS, Planner
from sheath_manip.tasks.platformer.stage import Stage
from sheath_manip.tasks.platformer.task import PlatformerTask
from sheath_manip.types import Action, Observation

FOLLOWED_STEPS = 8
"""of a plan, before another one looks farther ahead"""


class PlatformerExpert:
    """Sees the stage and the enemies as they are, and plans from any state.

    A plan is followed as long as the game is, to the bit, where the plan said it would be; where
    somebody else acted otherwise, it is made anew.
    """

    def __init__(self, environment: ComposerEnvironment) -> None:
        if not isinstance(environment.task, PlatformerTask):
            raise TypeError(f"PlatformerExpert wants a PlatformerTask, got {environment.task!r}")
        self._task = environment.task
        self.planner = Planner()
        self._stage: Stage | None = None
        self._way: dict[Moment, Buttons] = {}

    def reset(self) -> None:
        """Forget the plan."""
        self._way = {}

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """(4,) buttons, 0 or 1."""
        moment = self._task.moment
        if self._task.stage is not self._stage:
            self._stage, self._way = self._task.stage, {}
            self.planner.begin(self._stage)
        if moment not in self._way:
            plan = self.planner.plan(moment)
            self._way = dict(self.planner.followed(plan, FOLLOWED_STEPS))
        # Where all ways lead to death there is none; then to run on is as good as anything.
        return np.array(self._way.get(moment, ACTIONS[0]), np.float32)
