"""The platformer as a task: its variants, its expert, a fallback, and how a person plays it."""

from functools import partial

import numpy as np

from sheath_manip.controllers.hold import Hold
from sheath_manip.controllers.teleop.buttons import Button, ButtonHands
from sheath_manip.seeding import seed_for
from sheath_manip.task import Task
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.platformer.expert import PlatformerExpert
from sheath_manip.tasks.platformer.game import Buttons
from sheath_manip.tasks.platformer.picture import film_frame
from sheath_manip.tasks.platformer.task import PlatformerTask, Scenario
from sheath_manip.types import Action

IMAGE_PX = 84
DRAWN = 2**31
"""a reset without a stage of its own draws a stage's number below this (`PlatformerTask`)"""
_LOTS = ("run", "tuning")
"""of stages, 2**30 numbers each from `DRAWN` on"""


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(PlatformerTask(scenario))


def make_stage(number: int) -> ComposerEnvironment:
    """An environment whose episodes are all on the stage of that number."""
    return make(Scenario(stage=number))


def stage_number(lot: str, run_seed: int) -> int:
    """Return the number of a training run's stage, which no reset draws and no other lot has.

    So what is tuned on stages of its own, or judged on fresh ones, never meets a run's.
    """
    return DRAWN + _LOTS.index(lot) * 2**30 + seed_for("stage", lot, run_seed)


def make_stage_of(lot: str, run_seed: int) -> ComposerEnvironment:
    """An environment on the stage of the training run with that seed."""
    return make_stage(stage_number(lot, run_seed))


def buttons(pressed: frozenset[str]) -> Action:
    """(4,) 0 or 1: left and right at once are none."""
    both = {"left", "right"} <= pressed
    names = pressed - {"left", "right"} if both else pressed
    return np.array([name in names for name in Buttons._fields], np.float32)


def teleop(environment: ComposerEnvironment) -> ButtonHands:
    """Return how a person presses the buttons; one begins a turn and presses none."""
    del environment
    return ButtonHands(
        {
            "left": Button("KeyJ", "left", stick=-1),
            "right": Button("KeyL", "right", stick=1),
            "stand": Button("KeyK", "stand"),
            "jump": Button("KeyI", "jump", pad=0),
            "speed": Button("KeyU", "run", pad=2),
        },
        buttons,
    )


def hold(environment: ComposerEnvironment) -> Hold:
    """Return a controller that presses nothing."""
    del environment
    return Hold(lambda: buttons(frozenset()))


PLATFORMER = Task(
    name="platformer",
    summary="run and jump over gaps, pipes and enemies to a flag, seen as a grid of tiles",
    variants={
        "default": partial(make, Scenario()),
        # Every seed is a new stage, so the default's are new ones as well.
        "final": partial(make, Scenario()),
        "one-stage": partial(make_stage, 0),
        "pixels": partial(make, Scenario(image_px=IMAGE_PX)),
    },
    run_variants={
        "stage": partial(make_stage_of, "run"),
        "tuning-stage": partial(make_stage_of, "tuning"),
    },
    expert=PlatformerExpert,
    teleop=teleop,
    fallbacks={"hold": hold},
    picture=film_frame,
)
