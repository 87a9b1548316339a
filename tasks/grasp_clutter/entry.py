"""Grasping in clutter's entry in the table of tasks."""

from functools import partial

from sheath_manip.plan import LearningPlan
from sheath_manip.task import TaskEntry
from tasks.composer_environment import ComposerEnvironment
from tasks.grasp_clutter.expert import GraspExpert
from tasks.grasp_clutter.scene import EASY
from tasks.grasp_clutter.task import GraspTask, Scenario
from tasks.robots.jaco import JACO_WITH_JAW


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(GraspTask(scenario))


GRASP_CLUTTER = TaskEntry(
    name="grasp-clutter",
    summary="reach through standing clutter, grasp the red target and lift it",
    variants={
        "default": partial(make, Scenario()),
        # Every seed is a new scene, so the default's are new ones as well.
        "final": partial(make, Scenario()),
        "easy": partial(make, Scenario(difficulty=EASY)),
        "jaco": partial(make, Scenario(robot=JACO_WITH_JAW)),
    },
    expert=GraspExpert,
    plans={
        "full": LearningPlan(),
        "quick": LearningPlan(
            methods=("dagger", "sheath"), seeds=(0,), rounds=2, episodes=2, held_out=2, final=2
        ),
    },
)
