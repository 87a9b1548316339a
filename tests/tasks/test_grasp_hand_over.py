"""The arm does not jump when another takes over, and what the filter changed can be seen."""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np
import pytest

from sheath_manip.controllers.joint_limits import JointLimits
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.metrics import record_of
from sheath_manip.protocols import Follows, TakesOver
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER, drive_of
from sheath_manip.tasks.grasp_clutter.scene import EASY
from sheath_manip.tasks.grasp_clutter.task import CONTROL_TIMESTEP_S, GraspTask, Scenario
from sheath_manip.tasks.robots.own_arm import ARM_WITH_JAW
from sheath_manip.types import (
    Action,
    Actor,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Observations,
    Proposal,
    Purpose,
    Reason,
)

SEED = 5
INFO = EpisodeInfo("grasp-clutter", SEED, Purpose.LEARNING, 20.0)
JOINT_SPEEDS = tuple(ARM_WITH_JAW.joint_speeds_rad_s.values())
ROUNDING = 1e-9
TIME_LIMIT_S = 3.0


class Turns:
    """Each acts for so many steps."""

    def __init__(self, steps: int) -> None:
        self.steps = steps
        self.count = 0

    def reset(self, rng: np.random.Generator) -> None:
        del rng
        self.count = 0

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        del observation, proposal
        actor = (Actor.POLICY, Actor.EXPERT)[self.count // self.steps % 2]
        self.count += 1
        return GateDecision(actor, False, Reason.FIXED)


class Opponent:
    """Wants one thing at full speed, and for a while another: a policy, or an expert."""

    def __init__(self, sign: float) -> None:
        self.sign = sign
        self.steps = 0

    def reset(self, rng: np.random.Generator | None = None) -> None:
        del rng
        self.steps = 0

    def propose(self, observations: Observations) -> Proposal:
        del observations
        return Proposal(self._wish()[None])

    def act(self, observation: Observation) -> Action:
        del observation
        return self._wish()

    def _wish(self) -> Action:
        self.steps += 1
        way = np.array([1, 1, 1, -1, 1, 1, 0]) if self.steps % 40 < 30 else -np.ones(7)
        return (self.sign * way).astype(np.float32)


class Rates:
    """Listens to the rates that the servos are commanded."""

    def __init__(self, environment: ComposerEnvironment) -> None:
        assert isinstance(environment.task, GraspTask)
        self.servos = environment.physics.bind(environment.task.robot.servos).element_id
        self.rates: list[np.ndarray] = []

    def on_fit(self, states) -> None:
        del states

    def on_start(self, environment, info) -> None:
        del environment, info
        self.rates.append(np.zeros(len(self.servos)))

    def on_step(self, environment, step) -> None:
        del step
        self.rates.append(environment.physics.data.ctrl[self.servos].copy())

    def on_end(self, episode) -> None:
        del episode


@pytest.fixture(scope="module")
def environment() -> Iterator[ComposerEnvironment]:
    # Without cameras, and short.
    task = GraspTask(Scenario(difficulty=EASY, cameras=(), time_limit_s=TIME_LIMIT_S))
    environment = ComposerEnvironment(task)
    yield environment
    environment.close()


def contested(environment, steps: int, listeners=()) -> Episode:
    return rollout(
        environment,
        INFO,
        Turns(steps),
        rng=np.random.default_rng(0),
        policy=Opponent(1.0),
        expert=Opponent(-1.0),
        listeners=listeners,
    )


@pytest.mark.parametrize("steps", [1, 2, 3, 7])
def test_no_switch_changes_the_commanded_velocity_beyond_the_filters_limit(environment, steps):
    rates = Rates(environment)
    episode = contested(environment, steps, (rates,))
    command_filter = environment.task.drive.command_filter
    most = command_filter.stopping.most_change
    changes = np.abs(np.diff(np.array(rates.rates), axis=0))
    acted = [step.decision.actor for step in episode.steps]
    switches = np.array([False] + [a is not b for a, b in pairwise(acted)])
    assert switches.sum() >= len(episode) // steps - 1 > 3
    assert (changes[switches] <= most + ROUNDING).all()
    assert (changes <= most + ROUNDING).all()
    # They do disagree: they use all that there is.
    assert (changes[switches].max(0) > 0.9 * most).any()


def test_without_the_filter_it_jumps():
    scenario = Scenario(
        difficulty=EASY, cameras=(), time_limit_s=TIME_LIMIT_S, command_filter=False
    )
    environment = ComposerEnvironment(GraspTask(scenario))
    rates = Rates(environment)
    contested(environment, 3, (rates,))
    jumps = np.abs(np.diff(np.array(rates.rates), axis=0))
    joints = JointLimits.of(drive_of(environment).control.model, JOINT_SPEEDS)
    assert (jumps.max(0) > 1.2 * joints.accelerations_rad_s2 * CONTROL_TIMESTEP_S).any()
    environment.close()


def test_what_the_filter_changed_is_in_step_and_store(environment, tmp_path):
    episode = contested(environment, 3)
    limited = [step for step in episode.steps if step.limited]
    assert {"joint acceleration"} <= {each.limit for step in limited for each in step.limited}
    for step in episode.steps:
        acting = step.labelled if step.decision.actor is Actor.EXPERT else step.proposed
        assert step.requested is acting
        if not step.limited:
            np.testing.assert_array_equal(step.executed, step.requested)
    assert any(np.abs(step.executed - step.requested).max() > 0.1 for step in limited)
    assert record_of(episode).limited_steps == len(limited) > 10
    store = EpisodeStore.create(tmp_path / "store")
    read = store.read(store.append(episode))
    assert [step.limited for step in read.steps] == [step.limited for step in episode.steps]


def test_wishes_run_the_episode_again_to_the_bit(environment):
    episode = contested(environment, 3)
    environment.reset(SEED)
    for step in episode.steps:
        np.testing.assert_array_equal(environment.state(), step.state)
        environment.step(step.requested)
    np.testing.assert_array_equal(environment.state(), episode.final_state)
    # And from the midst.
    middle = len(episode) // 2
    environment.restore(episode.steps[middle].state)
    for step in episode.steps[middle:]:
        environment.step(step.requested)
    np.testing.assert_array_equal(environment.state(), episode.final_state)


def test_the_executed_twist_is_what_the_tool_was_commanded(environment):
    environment.reset(SEED)
    drive = environment.task.drive
    rng, wish = np.random.default_rng(1), np.zeros(7, np.float32)
    for number in range(40):
        if number % 8 == 0:
            wish = rng.uniform(-1, 1, 7).astype(np.float32)
        before = drive.commanded_tool_pose()
        transition = environment.step(wish)
        moved_m = drive.commanded_tool_pose()[:3, 3] - before[:3, 3]
        executed = transition.commanded.action
        velocity_m_s = moved_m / CONTROL_TIMESTEP_S
        # Where nothing acted the inverse kinematics is as good as its posture lets it.
        np.testing.assert_allclose(executed[:3] * 0.25, velocity_m_s, atol=6e-3)


@pytest.mark.parametrize("name", ["hold", "back-up"])
def test_stand_ins_take_over_from_a_policy_that_runs_away(name, environment):
    stand_in = GRASP_CLUTTER.make_expert(environment, name)
    assert isinstance(stand_in, Follows) == (name == "back-up")
    assert not isinstance(stand_in, TakesOver)
    observation = environment.reset(SEED)
    stand_in.reset()
    drive = environment.task.drive
    away = np.array([-1, 0.3, 0.2, 0, 0, 0, -1], np.float32)
    places = []
    for _ in range(20):
        if isinstance(stand_in, Follows):
            stand_in.follow(observation)
        places.append(drive.commanded_tool_pose()[:3, 3])
        observation = environment.step(away).observation
    here_m = left_m = drive.commanded_tool_pose()[:3, 3]
    for _ in range(60):
        if isinstance(stand_in, Follows):
            stand_in.follow(observation)
        observation = environment.step(stand_in.act(observation)).observation
        here_m = drive.commanded_tool_pose()[:3, 3]
        if name == "back-up":
            assert min(np.linalg.norm(here_m - place) for place in places) < 0.03
    goal_m, reach_m = (left_m, 0.05) if name == "hold" else (places[0], 0.01)
    assert np.linalg.norm(here_m - goal_m) < reach_m
    assert np.abs(drive.command_filter.velocities_rad_s).max() < 0.05
    assert np.linalg.norm(left_m - places[0]) > 0.15
