"""The platformer's entry in the table of tasks."""

from dataclasses import replace
from functools import partial

from sheath_manip.plan import LearningPlan
from sheath_manip.task import TaskEntry
from tasks.composer_environment import ComposerEnvironment
from tasks.platformer.expert import PlatformerExpert
from tasks.platformer.task import PlatformerTask, Scenario

IMAGE_PX = 84


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(PlatformerTask(scenario))


def make_stage(number: int) -> ComposerEnvironment:
    """An environment whose episodes are all on the stage of that number."""
    return make(Scenario(stage=number))


# As in the draft: linear policies and a one-class SVM, both on the binary features themselves.
_FULL = LearningPlan(
    policy="linear-svm",
    embedding="features",
    precedent_embedding="features",
    support="one-class-svm",
)

PLATFORMER = TaskEntry(
    name="platformer",
    summary="run and jump over gaps, pipes and enemies to a flag, seen as a grid of tiles",
    variants={
        "default": partial(make, Scenario()),
        # Every seed is a new stage, so the default's are new ones as well.
        "final": partial(make, Scenario()),
        "one-stage": partial(make_stage, 0),
        "pixels": partial(make, Scenario(image_px=IMAGE_PX)),
    },
    expert=PlatformerExpert,
    plans={
        "full": _FULL,
        "quick": replace(
            _FULL,
            methods=("dagger", "sheath"),
            seeds=(0,),
            demonstrations=6,
            calibration=4,
            check=3,
            rounds=2,
            episodes=4,
            held_out=3,
            final=2,
        ),
    },
)
