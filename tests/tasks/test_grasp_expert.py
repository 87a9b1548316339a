"""The expert for grasping in clutter: solves scenes, takes over, says when it cannot."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.seeding import scene_seed
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.grasp_state import Intent
from sheath_manip.tasks.grasp_clutter.guide import GraspGuide
from sheath_manip.tasks.grasp_clutter.objects import Kind, StandingObject
from sheath_manip.tasks.grasp_clutter.rehearsal import solvable
from sheath_manip.tasks.grasp_clutter.scene import EASY, Scene
from sheath_manip.tasks.grasp_clutter.task import CONTROL_TIMESTEP_S, GraspTask, Scenario
from sheath_manip.tasks.robots.jaco import JACO_WITH_JAW
from sheath_manip.types import Observation, Outcome, Purpose

TARGET = StandingObject(Kind.CAN, 0.03, 0.03, 0.12, 0.2, 0.45, 0.0, 0.0, (1, 0, 0, 1))


class Player:
    """An environment without cameras, with its expert."""

    def __init__(self, scenario: Scenario) -> None:
        self.task = GraspTask(scenario)
        self.environment = ComposerEnvironment(self.task)
        self.expert = GraspExpert(self.environment)

    def begin(self, number: int) -> Observation:
        observation = self.environment.reset(scene_seed(Purpose.EVALUATION, "tests", number))
        self.expert.reset()
        return observation

    def play(self, observation: Observation, steps: int = 1000) -> Observation:
        for _ in range(steps):
            transition = self.environment.step(self.expert.act(observation))
            observation = transition.observation
            if transition.terminated or transition.truncated:
                break
        return observation


@pytest.fixture(scope="module")
def player() -> Iterator[Player]:
    player = Player(Scenario(cameras=()))
    yield player
    player.environment.close()


def walled_in() -> Scene:
    """A target with tall bottles, cans and boxes all around, at 22 mm."""
    kinds = [Kind.CAN, Kind.BOTTLE, Kind.BOX] * 2
    away = 0.03 + 0.022 + 0.027
    clutter = [
        StandingObject(kind, 0.027, 0.027, 0.2, 0.2, 0, 0, 0.0, (0, 0, 1, 1)) for kind in kinds
    ]
    angles = np.arange(6) * np.pi / 3
    placed = [
        replace(
            each,
            x_m=float(TARGET.x_m + away * np.cos(angle)),
            y_m=float(away * np.sin(angle)),
            yaw_rad=float(angle),
        )
        for each, angle in zip(clutter, angles, strict=True)
    ]
    return Scene(TARGET, tuple(placed))


@pytest.mark.parametrize("number", range(4))
def test_solves_hard_scenes_without_touching_the_clutter(number, player):
    player.play(player.begin(number))
    assert player.environment.outcome() is Outcome.SUCCESS
    assert player.environment.metrics()["tilt_deg"] < 5


def test_a_target_that_is_walled_in_cannot_be_grasped():
    robot = Scenario().robot
    guide = GraspGuide(robot, CONTROL_TIMESTEP_S)
    assert not solvable(guide, walled_in(), np.array(robot.home_rad))
    alone = Scene(TARGET, (replace(walled_in().clutter[0], x_m=0.6, y_m=0.3),))
    assert solvable(guide, alone, np.array(robot.home_rad))


def test_backs_out_where_there_is_no_way_in_and_says_so(player):
    observation = player.begin(0)
    physics = player.environment.physics
    player.task.lay(physics, walled_in(), np.array(player.task.scenario.robot.home_rad))
    player.play(observation, steps=60)
    assert player.expert.intent is Intent.BACK_OUT
    assert player.environment.outcome() is Outcome.TIME_LIMIT
    assert player.environment.metrics()["tilt_deg"] < 1


def interrupted(player: Player, number: int) -> Observation | None:
    """What is seen after an erring driver; None where it left nothing to take over."""
    rng = np.random.default_rng(number)
    observation = player.begin(10 + number)
    observation = player.play(observation, steps=int(rng.integers(5, 35)))
    for _ in range(30):
        erring = player.expert.act(observation) + rng.normal(0, 0.3, 7).astype(np.float32)
        transition = player.environment.step(np.clip(erring, -1, 1))
        observation = transition.observation
        if transition.terminated:
            return None
    return observation


@pytest.mark.parametrize("number", range(6))
def test_takes_over_from_a_policy_that_errs(number, player):
    # A noisy driver topples something in one scene of a dozen by itself.
    tries = (interrupted(player, number + 6 * again) for again in range(3))
    observation = next(each for each in tries if each is not None)
    player.play(observation)
    assert player.environment.outcome() is Outcome.SUCCESS


def test_its_labels_hardly_differ_between_neighbouring_states(player):
    rng = np.random.default_rng(0)
    observation = player.begin(20)
    physics, guide = player.environment.physics, player.expert._guide
    jumps = []
    for _ in range(70):
        situation = player.task.situation(physics)
        here, _ = guide.action(situation)
        joints = situation.joint_targets_rad + rng.normal(0, 2e-4, 6)
        there, _ = guide.action(replace(situation, joint_targets_rad=joints))
        jumps.append(np.abs(here[:6] - there[:6]).max())
        observation = player.play(observation, steps=1)
    assert np.median(jumps) < 0.02
    assert max(jumps) < 0.25


def test_opens_its_hand_before_it_goes_down(player):
    """From the closed jaw above the target, as a policy that closed too early leaves it."""
    observation = player.play(player.begin(21), steps=25)
    for _ in range(16):
        observation = player.environment.step(
            np.array([0, 0, 0.3, 0, 0, 0, 1], np.float32)
        ).observation
    assert player.task.drive.closed_m() > 0.085
    player.play(observation)
    assert player.environment.outcome() is Outcome.SUCCESS


def test_another_arm_is_another_description():
    player = Player(Scenario(difficulty=EASY, robot=JACO_WITH_JAW, cameras=()))
    player.play(player.begin(0))
    assert player.environment.outcome() is Outcome.SUCCESS
    player.environment.close()
