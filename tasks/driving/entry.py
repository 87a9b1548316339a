"""Driving as a task: its variants, its expert, and how a person steers it."""

from functools import partial

import numpy as np

from sheath_manip.controllers.teleop.buttons import Button, ButtonHands
from sheath_manip.task import Task
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.picture import film_frame
from sheath_manip.tasks.driving.task import STEERING_RAD, DrivingTask, Scenario
from sheath_manip.tasks.opengl import require_opengl
from sheath_manip.types import Action


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(DrivingTask(scenario))


def steering(pressed: frozenset[str]) -> Action:
    """(1,) rad: both ways at once go straight on."""
    return np.array([STEERING_RAD * (("left" in pressed) - ("right" in pressed))], np.float32)


def teleop(environment: ComposerEnvironment) -> ButtonHands:
    """Return how a person steers: two keys, a stick; and a key to begin a turn straight on."""
    del environment
    buttons = {
        "left": Button("KeyJ", "left", stick=-1),
        "right": Button("KeyL", "right", stick=1),
        "straight": Button("KeyK", "straight on"),
    }
    return ButtonHands(buttons, steering)


DRIVING = Task(
    name="driving",
    summary="laps on a closed track among slower cars, steered from an overhead camera",
    variants={
        "default": partial(make, Scenario()),
        # The last policies are judged over three laps.
        "final": partial(make, Scenario(laps=3.0)),
        # The draft's camera: 500 px and two levels of the pyramid, three times as dear a frame and
        # 0.8/255 away from the default's.
        "paper-camera": partial(make, Scenario(render_px=500, pyramid_levels=2)),
    },
    expert=DrivingExpert,
    teleop=teleop,
    require=require_opengl,
    picture=film_frame,
)
