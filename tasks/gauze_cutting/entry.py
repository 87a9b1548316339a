"""Gauze cutting's entry in the table of tasks."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.hold import Hold
from sheath_manip.controllers.teleop.planar import PlanarHands
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.support.config import ThresholdConfig
from sheath_manip.task import Task
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.claims import CLAIMS
from sheath_manip.tasks.gauze_cutting.expert import GauzeExpert, task_of
from sheath_manip.tasks.gauze_cutting.open_loops import blind, registered
from sheath_manip.tasks.gauze_cutting.probes import PROBES
from sheath_manip.tasks.gauze_cutting.scene import CALM
from sheath_manip.tasks.gauze_cutting.steering import HEADING_CHANGE, TOP_SPEED_M_S
from sheath_manip.tasks.gauze_cutting.task import GauzeTask, Scenario


def make(scenario: Scenario) -> ComposerEnvironment:
    """An environment of this task."""
    return ComposerEnvironment(GauzeTask(scenario))


def hold(environment: ComposerEnvironment) -> Hold:
    """Stands still."""
    return Hold(task_of(environment).rest)


def hands(environment: ComposerEnvironment) -> PlanarHands:
    """A person's, on the blade."""
    task = task_of(environment)
    return PlanarHands(
        task.drive.commanded_tool_pose,
        lambda velocity: task.scenario.steering.action_for(velocity, task.heading),
        TOP_SPEED_M_S,
    )


def picture(environment: ComposerEnvironment) -> NDArray[np.uint8]:
    """`figures.film_frame`, which is imported only when a film is made."""
    from sheath_manip.tasks.gauze_cutting.figures import film_frame

    return film_frame(environment)


_FULL = LearningPlan(
    policy=PolicyConfig("egocentric-cnn", {"spatial_settings": {"steps": 800, "warm_steps": 600}}),
    gate=GateConfig(
        signal="near-joined",
        embedding="tool-points",
        precedent_embedding="tool-points",
        threshold=ThresholdConfig(false_alarm_rate=0.1),
        minimum_hold_steps=5,
    ),
    schedule=Schedule(
        # Few and clean: a policy cloned from them ruins most sheets. Where the expert's hand is
        # pushed about (`demonstration_noise` of .1) five will do to free 11 of 12 tuning scenes'
        # discs, and there is little to learn.
        demonstrations=20,
        calibration=15,
        false_alarm_episodes=8,
        rounds=5,
        episodes=10,
        refit_unused=False,
    ),
    comparison=Comparison(evaluation_episodes=6, final_episodes=40),
)

GAUZE_CUTTING = Task(
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
    hands=hands,
    stand_ins={"hold": hold},
    plans={
        "full": _FULL,
        "quick": _FULL.changed(
            policy={"settings": {"spatial_settings": {"steps": 40, "warm_steps": 10}}},
            schedule={
                "demonstrations": 4,
                "calibration": 3,
                "false_alarm_episodes": 1,
                "rounds": 1,
                "episodes": 2,
            },
            comparison={
                "methods": ("dagger", "sheath"),
                "seeds": (0,),
                "evaluation_episodes": 1,
                "final_episodes": 1,
            },
        ),
    },
    references={"registered": registered, "blind": blind},
    picture=picture,
    claims=CLAIMS,
    probes=PROBES,
)
