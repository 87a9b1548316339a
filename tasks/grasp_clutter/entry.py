"""Grasping in clutter's entry in the table of tasks."""

from functools import partial

from controllers.back_up import BackUp
from controllers.hold import Hold
from controllers.teleop.arm import ArmHands
from sheath_manip.plan import LearningPlan
from sheath_manip.task import TaskEntry
from tasks.composer_environment import ComposerEnvironment
from tasks.grasp_clutter.expert import GraspExpert
from tasks.grasp_clutter.scene import EASY
from tasks.grasp_clutter.task import CONTROL_TIMESTEP_S, GraspTask, Scenario
from tasks.robots import stand_ins
from tasks.robots.drive import RobotDrive
from tasks.robots.jaco import JACO_WITH_JAW


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(GraspTask(scenario))


def drive_of(environment: ComposerEnvironment) -> RobotDrive:
    """Of the robot in it."""
    if not isinstance(environment.task, GraspTask):
        raise TypeError(f"wanted the environment of a GraspTask, got {environment.task!r}")
    return environment.task.drive


def hold(environment: ComposerEnvironment) -> Hold:
    """Stands still."""
    return stand_ins.hold(drive_of(environment))


def back_up(environment: ComposerEnvironment) -> BackUp:
    """Goes back by the way that the tool came."""
    return stand_ins.back_up(drive_of(environment), CONTROL_TIMESTEP_S)


def hands(environment: ComposerEnvironment) -> ArmHands:
    """A person's."""
    return stand_ins.hands(drive_of(environment))


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
    hands=hands,
    stand_ins={"hold": hold, "back-up": back_up},
    plans={
        "full": LearningPlan(),
        "quick": LearningPlan(
            methods=("dagger", "sheath"), seeds=(0,), rounds=2, episodes=2, held_out=2, final=2
        ),
    },
)
