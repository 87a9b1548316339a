"""Gauze cutting's entry in the table of tasks."""

from functools import partial

from controllers.hold import Hold
from sheath_manip.plan import LearningPlan
from sheath_manip.task import TaskEntry
from tasks.composer_environment import ComposerEnvironment
from tasks.gauze_cutting.expert import GauzeExpert, task_of
from tasks.gauze_cutting.scene import CALM
from tasks.gauze_cutting.steering import HEADING_CHANGE
from tasks.gauze_cutting.task import GauzeTask, Scenario


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(GauzeTask(scenario))


def hold(environment: ComposerEnvironment) -> Hold:
    """Stands still."""
    return Hold(task_of(environment).rest)


GAUZE_CUTTING = TaskEntry(
    name="gauze-cutting",
    summary="guide a blade along the circle printed on a sheet of gauze that moves under it",
    variants={
        "default": partial(make, Scenario()),
        # Every seed is a new scene, so the default's are new ones as well.
        "final": partial(make, Scenario()),
        "heading": partial(make, Scenario(steering=HEADING_CHANGE)),
        "calm": partial(make, Scenario(difficulty=CALM)),
    },
    expert=GauzeExpert,
    stand_ins={"hold": hold},
    plans={
        "full": LearningPlan(policy="spatial-cnn"),
        "quick": LearningPlan(
            policy="spatial-cnn",
            methods=("dagger", "sheath"),
            seeds=(0,),
            rounds=2,
            episodes=2,
            held_out=2,
            final=2,
        ),
    },
)
