"""Grasping in clutter's entry in the table of tasks."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.back_up import BackUp
from sheath_manip.controllers.hold import Hold
from sheath_manip.controllers.teleop.arm import ArmHands
from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import Comparison, LearningPlan, Schedule
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.support.config import ThresholdConfig
from sheath_manip.task import Task
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.claims import CLAIMS, RECIPE
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.probes import PROBES
from sheath_manip.tasks.grasp_clutter.scene import EASY, MEDIUM
from sheath_manip.tasks.grasp_clutter.task import CONTROL_TIMESTEP_S, GraspTask, Scenario
from sheath_manip.tasks.robots import stand_ins
from sheath_manip.tasks.robots.drive import RobotDrive
from sheath_manip.tasks.robots.jaco import JACO_WITH_JAW


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


def picture(environment: ComposerEnvironment) -> NDArray[np.uint8]:
    """`figures.film_frame`, which is imported only when a film is made."""
    from sheath_manip.tasks.grasp_clutter.figures import film_frame

    return film_frame(environment)


_FULL = LearningPlan(
    policy=PolicyConfig("spatial-cnn", {"steps": 1000, "warm_steps": 600}),
    gate=GateConfig(
        signal="near-joined",
        embedding="wrist-convolutions",
        precedent_embedding="wrist-convolutions",
        threshold=ThresholdConfig(false_alarm_rate=0.1),
        minimum_hold_steps=5,
    ),
    schedule=Schedule(
        demonstrations=60,
        calibration=20,
        false_alarm_episodes=10,
        rounds=6,
        episodes=16,
        refit_unused=False,
        variant="medium",
    ),
    comparison=Comparison(evaluation_episodes=10, final_episodes=100, final_variant="medium"),
)

GRASP_CLUTTER = Task(
    name="grasp-clutter",
    summary="reach through standing clutter, grasp the red target and lift it",
    variants={
        "default": partial(make, Scenario()),
        # Every seed is a new scene, so the default's are new ones as well.
        "final": partial(make, Scenario()),
        "medium": partial(make, Scenario(difficulty=MEDIUM)),
        "easy": partial(make, Scenario(difficulty=EASY)),
        "jaco": partial(make, Scenario(robot=JACO_WITH_JAW)),
    },
    expert=GraspExpert,
    hands=hands,
    stand_ins={"hold": hold, "back-up": back_up},
    plans={
        "full": _FULL,
        "quick": _FULL.changed(
            policy={"settings": {"steps": 60, "warm_steps": 20}},
            schedule={
                "demonstrations": 6,
                "calibration": 4,
                "false_alarm_episodes": 2,
                "rounds": 2,
                "episodes": 3,
            },
            comparison={
                "methods": ("dagger", "sheath"),
                "seeds": (0,),
                "evaluation_episodes": 2,
                "final_episodes": 2,
            },
        ),
        # The same with less room between the objects.
        "hard": _FULL.changed(
            schedule={"variant": "default"}, comparison={"final_variant": "final"}
        ),
        # The best policy: many scenes, and a hand that is pushed about, which shows the ways back.
        "recipe": _FULL.changed(
            policy={"settings": {"steps": 4000, "warm_steps": 1000}},
            schedule={
                "demonstrations": 200,
                "demonstration_noise": 0.15,
                "calibration": 10,
                "false_alarm_episodes": 1,
                "rounds": 1,
                "episodes": 20,
            },
            comparison={"methods": ("cloning",), "seeds": (0,), "evaluation_episodes": 1},
        ),
    },
    picture=picture,
    claims=CLAIMS,
    plan_claims={"recipe": RECIPE},
    probes=PROBES,
)
