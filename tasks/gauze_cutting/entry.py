"""Gauze cutting as a task: its variants, its expert, a fallback, and how a person guides it."""

from sheath_manip.controllers.hold import Hold
from sheath_manip.controllers.teleop.planar import PlanarHands
from sheath_manip.task import Task
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.expert import GauzeExpert, task_of
from sheath_manip.tasks.gauze_cutting.picture import film_frame
from sheath_manip.tasks.gauze_cutting.scenario import Scenario
from sheath_manip.tasks.gauze_cutting.scene import CALM
from sheath_manip.tasks.gauze_cutting.steering import HEADING_CHANGE, TOP_SPEED_M_S
from sheath_manip.tasks.gauze_cutting.task import GauzeTask
from sheath_manip.tasks.opengl import require_opengl
from sheath_manip.tasks.robots.described import arm_with_blade
from sheath_manip.tasks.robots.jaco import JACO_WITH_BLADE
from sheath_manip.tasks.robots.variants import ArmVariants


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(GauzeTask(scenario))


def hold(environment: ComposerEnvironment) -> Hold:
    """Return a controller that stands still."""
    return Hold(task_of(environment).rest)


def teleop(environment: ComposerEnvironment) -> PlanarHands:
    """Return how a person guides the blade."""
    task = task_of(environment)
    return PlanarHands(
        task.drive.commanded_tool_pose,
        lambda velocity: task.scenario.steering.action_for(velocity, task.heading),
        TOP_SPEED_M_S,
    )


GAUZE_CUTTING = Task(
    name="gauze-cutting",
    summary="guide a blade along the circle printed on a sheet of gauze that moves under it",
    variants=ArmVariants(
        make,
        {
            "default": Scenario(),
            # Every seed is a new scene, so the default's are new ones as well.
            "final": Scenario(),
            "heading": Scenario(steering=HEADING_CHANGE),
            "calm": Scenario(difficulty=CALM),
        },
        {"jaco": JACO_WITH_BLADE},
        arm_with_blade,
    ),
    expert=GauzeExpert,
    teleop=teleop,
    require=require_opengl,
    fallbacks={"hold": hold},
    picture=film_frame,
)
