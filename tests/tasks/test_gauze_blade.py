"""How the blade of gauze cutting is steered: its servo and drag, actions, expert and measures."""

import mujoco
import numpy as np
import pytest

from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.gauze_cutting.expert import GauzeExpert
from sheath_manip.tasks.gauze_cutting.geometry import RADIUS_M
from sheath_manip.tasks.gauze_cutting.measures import path_measures
from sheath_manip.tasks.gauze_cutting.scenario import CONTROL_TIMESTEP_S, Scenario
from sheath_manip.tasks.gauze_cutting.scene import CALM
from sheath_manip.tasks.gauze_cutting.steering import HEADING_CHANGE, PLANAR_VELOCITY
from sheath_manip.tasks.gauze_cutting.study.open_loops import nominal, registered
from sheath_manip.tasks.gauze_cutting.task import DEPTH_M, GauzeTask
from sheath_manip.types import Outcome
from tests.tasks.gauze_bench import SEED, bench

__all__ = ["bench"]


def test_the_depth_is_servoed_and_the_velocity_is_what_was_asked(bench):
    bench.environment.reset(SEED)
    along = (0.5 * bench.task.heading).astype(np.float32)
    bench.steps(5, along)
    before = bench.task.tip_m
    bench.steps(5, along)
    moved = (bench.task.tip_m - before) / (5 * CONTROL_TIMESTEP_S)
    np.testing.assert_allclose(moved, [*(0.03 * along), 0.0], atol=1e-3)
    assert bench.task.tip_m[2] == pytest.approx(0.15 - DEPTH_M, abs=3e-4)
    commanded = bench.task.commanded()
    assert commanded is not None
    np.testing.assert_allclose(commanded.action, along, atol=0.02)


def test_the_blade_drags_the_sheet_and_the_sheet_the_arm(bench):
    bench.environment.reset(SEED)
    bench.steps(20)
    applied, drag = bench.data.qfrc_applied.copy(), bench.task.knife.drag_n
    assert np.linalg.norm(drag) == pytest.approx(bench.task.scene.drag_n, rel=0.2)
    held = bench.task.knife.held_vertices()
    columns = bench.task.workpiece.sheet.dofs[held][:, None] + np.arange(3)
    bench.steps(1)
    assert np.abs(applied[columns]).max() > 0
    joints = bench.environment.physics.bind(bench.task.robot.joints)
    arm = bench.data.qfrc_applied[np.atleast_1d(joints.dofadr)]
    jacobian = np.zeros((3, bench.model.nv))
    tip = np.atleast_1d(bench.environment.physics.bind(bench.task.robot.tool_site).element_id)[0]
    mujoco.mj_jacSite(bench.model, bench.data, jacobian, None, int(tip))
    wanted = -jacobian[:, np.atleast_1d(joints.dofadr)].T @ drag
    np.testing.assert_allclose(arm, wanted, atol=2e-3)


@pytest.mark.parametrize("aside_m", [-0.002, 0.002])
def test_the_expert_comes_back_to_the_line(bench, aside_m):
    bench.environment.reset(SEED)
    bench.steps(10)
    while True:
        path = bench.task.knife.path_m[-1]
        outwards = bench.task.scene.rotation @ (path / np.linalg.norm(path))
        if abs(np.linalg.norm(path) - RADIUS_M) >= abs(aside_m):
            break
        bench.steps(1, (0.6 * np.sign(aside_m) * outwards).astype(np.float32))
    bench.steps(30)
    assert bench.environment.outcome() is Outcome.TIME_LIMIT
    path = bench.task.knife.path_m
    assert np.abs(np.linalg.norm(path[-5:], axis=1) - RADIUS_M).max() < 3e-4


@pytest.mark.parametrize("steering", [PLANAR_VELOCITY, HEADING_CHANGE])
def test_an_action_asks_for_the_velocity_that_it_was_made_for(steering):
    rng = np.random.default_rng(0)
    for _ in range(20):
        angle = rng.uniform(-np.pi, np.pi)
        heading = np.array([np.cos(angle), np.sin(angle)])
        turned = angle + rng.uniform(-0.45, 0.45)
        velocity = rng.uniform(0.001, 0.03) * np.array([np.cos(turned), np.sin(turned)])
        action = steering.action.validated(steering.action_for(velocity, heading))
        np.testing.assert_allclose(
            steering.velocity_m_s(action, heading), velocity, rtol=1e-5, atol=1e-9
        )
    # Backwards is not to be had by turning; faster than the fastest by neither.
    far = steering.action_for(np.array([-1.0, 0.0]), np.array([1.0, 0.0]))
    assert np.linalg.norm(steering.velocity_m_s(far, np.array([1.0, 0.0]))) == pytest.approx(0.03)
    still = steering.action_for(np.zeros(2), np.array([1.0, 0.0]))
    assert not steering.velocity_m_s(still, np.array([1.0, 0.0])).any()


def test_the_expert_steers_by_heading_as_well():
    task = GauzeTask(Scenario(cameras=(), difficulty=CALM, steering=HEADING_CHANGE))
    environment = ComposerEnvironment(task)
    expert = GauzeExpert(environment)
    environment.reset(SEED)
    for _ in range(60):
        environment.step(expert.act(environment.observe()))
    assert environment.metrics()["largest_deviation_mm"] < 0.8
    assert environment.metrics()["covered"] > 0.3
    environment.close()


def test_the_open_loop_looks_once(bench):
    bench.environment.reset(SEED)
    actor = registered(bench.environment)
    actor.reset()
    observation = bench.environment.observe()
    first = actor.act(observation)
    # A pushed sheet does not change its mind.
    bench.data.qpos[bench.task.workpiece.sheet.coordinates[100]] += 0.003
    mujoco.mj_kinematics(bench.model, bench.data)
    np.testing.assert_array_equal(actor.act(observation), first)
    assert nominal(bench.task).of(np.zeros(2)).world_m[2] == pytest.approx(0.15)


def test_measures_of_a_path():
    angles = np.linspace(0, np.pi, 400)
    path = (RADIUS_M + 0.0004) * np.column_stack([np.cos(angles), np.sin(angles)])
    found = path_measures(path, RADIUS_M)
    assert found.deviation_m == pytest.approx(0.0004)
    assert found.covered == pytest.approx(0.5, abs=0.03)
    aside = path_measures(path * 1.1, RADIUS_M)
    assert aside.covered == 0
    assert aside.largest_deviation_m > 0.0025
