"""Grasping in clutter as a task: variants, expert, fallbacks, and how a person moves the arm."""

from sheath_manip.controllers.back_up import BackUp
from sheath_manip.controllers.hold import Hold
from sheath_manip.controllers.teleop.arm import ArmHands
from sheath_manip.task import Task
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.picture import film_frame
from sheath_manip.tasks.grasp_clutter.scene import EASY, MEDIUM
from sheath_manip.tasks.grasp_clutter.task import CONTROL_TIMESTEP_S, GraspTask, Scenario
from sheath_manip.tasks.opengl import require_opengl
from sheath_manip.tasks.robots import fallbacks
from sheath_manip.tasks.robots.described import arm_with_gripper
from sheath_manip.tasks.robots.drive import RobotDrive
from sheath_manip.tasks.robots.jaco import JACO_WITH_JAW
from sheath_manip.tasks.robots.variants import ArmVariants


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(GraspTask(scenario))


def drive_of(environment: ComposerEnvironment) -> RobotDrive:
    """Return the drive of the robot in it."""
    if not isinstance(environment.task, GraspTask):
        raise TypeError(f"wanted the environment of a GraspTask, got {environment.task!r}")
    return environment.task.drive


def hold(environment: ComposerEnvironment) -> Hold:
    """Return a controller that stands still."""
    return fallbacks.hold(drive_of(environment))


def back_up(environment: ComposerEnvironment) -> BackUp:
    """Return a controller that goes back by the way that the tool came."""
    return fallbacks.back_up(drive_of(environment), CONTROL_TIMESTEP_S)


def teleop(environment: ComposerEnvironment) -> ArmHands:
    """Return how a person moves the arm."""
    return fallbacks.teleop(drive_of(environment))


GRASP_CLUTTER = Task(
    name="grasp-clutter",
    summary="reach through standing clutter, grasp the red target and lift it",
    variants=ArmVariants(
        make,
        {
            "default": Scenario(),
            # Every seed is a new scene, so the default's are new ones as well.
            "final": Scenario(),
            "medium": Scenario(difficulty=MEDIUM),
            "easy": Scenario(difficulty=EASY),
        },
        {"jaco": JACO_WITH_JAW},
        arm_with_gripper,
    ),
    expert=GraspExpert,
    teleop=teleop,
    require=require_opengl,
    fallbacks={"hold": hold, "back-up": back_up},
    picture=film_frame,
)
