"""Driving's entry in the table of tasks."""

from functools import partial
from typing import Any

import numpy as np

from sheath_manip.controllers.teleop.buttons import Button, ButtonHands
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.support.config import ThresholdConfig
from sheath_manip.task import Task
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.claims import CLAIMS
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.probes import PROBES
from sheath_manip.tasks.driving.task import STEERING_RAD, DrivingTask, Scenario
from sheath_manip.types import Action


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(DrivingTask(scenario))


def steering(pressed: frozenset[str]) -> Action:
    """(1,) rad: both ways at once go straight on."""
    return np.array([STEERING_RAD * (("left" in pressed) - ("right" in pressed))], np.float32)


def hands(environment: ComposerEnvironment) -> ButtonHands:
    """A person's, at the wheel."""
    del environment
    buttons = {
        "left": Button("KeyJ", "left", stick=-1),
        "right": Button("KeyL", "right", stick=1),
    }
    return ButtonHands(buttons, steering)


def support_figure(*arguments: Any) -> None:
    """`figures.support`, which imports matplotlib only when it is drawn."""
    from sheath_manip.tasks.driving.figures import support

    support(*arguments)


def gate_map_figure(*arguments: Any) -> None:
    """`figures.gate_map`, likewise."""
    from sheath_manip.tasks.driving.figures import gate_map

    gate_map(*arguments)


# For how the support's size changes learning (the draft's section IV-B): the support alone, at its
# own boundary.
_NU = LearningPlan(
    gate=GateConfig(signal="support", threshold=ThresholdConfig(rule="boundary")),
    schedule=Schedule(
        demonstrations=6, calibration=3, false_alarm_episodes=3, rounds=4, episodes=4
    ),
    comparison=Comparison(methods=("sheath",), seeds=(0,), evaluation_episodes=8, final_episodes=1),
)

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
    hands=hands,
    plans={
        "full": LearningPlan(),
        # As in the draft: three laps, one convolution layer, the support on its last hidden layer.
        "paper": LearningPlan(
            policy=PolicyConfig("paper-cnn"),
            gate=GateConfig(embedding="penultimate"),
            schedule=Schedule(demonstrations=3),
        ),
        "nu": _NU,
        # Without a network to train.
        "nu-quick": _NU.changed(
            policy={"name": "hog-svm"},
            gate={"embedding": "pixels", "precedent_embedding": "pixels"},
            schedule={
                "demonstrations": 2,
                "false_alarm_episodes": 1,
                "rounds": 2,
                "episodes": 2,
            },
            comparison={"evaluation_episodes": 2},
        ),
        # Painting doubles a cold fit, and a first look can do without.
        "quick": LearningPlan(
            policy=PolicyConfig("plain-cnn"),
            schedule=Schedule(
                demonstrations=6, calibration=4, false_alarm_episodes=3, rounds=2, episodes=4
            ),
            comparison=Comparison(
                methods=("dagger", "sheath"),
                seeds=(0,),
                evaluation_episodes=3,
                final_episodes=2,
            ),
        ),
    },
    figures={"support.png": support_figure, "gate_map.png": gate_map_figure},
    claims=CLAIMS,
    probes=PROBES,
)
