"""Grasping in clutter by itself: scenes, how objects stand and fall, what counts as success."""

from collections.abc import Iterator
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from dm_control.rl.control import PhysicsError

from sheath_manip.dashboard.scene import upwards
from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.objects import Kind, StandingObject
from sheath_manip.tasks.grasp_clutter.scene import EASY, HARD, POOL, TARGET_RGBA, Scene, draw_scene
from sheath_manip.tasks.grasp_clutter.task import PHYSICS_TIMESTEP_S, TOPPLING, GraspTask, Scenario
from sheath_manip.types import Outcome

STILL = np.array([0, 0, 0, 0, 0, 0, -1], np.float32)


class Table:
    """An environment without cameras, and its task under a name of its own type."""

    def __init__(self) -> None:
        self.task = GraspTask(Scenario(cameras=()))
        self.environment = ComposerEnvironment(self.task)

    def lay(self, *clutter: StandingObject) -> None:
        self.environment.reset(0)
        home = np.array(self.task.scenario.robot.home_rad)
        self.task.lay(self.environment.physics, Scene(TARGET, clutter), home)

    def tilt(self, each: StandingObject, share: float) -> None:
        """Tip the first of the clutter towards its thinner side, by a share of its tip angle."""
        angle = share * each.tip_angle_rad
        along_y = each.half_y_m <= each.half_x_m
        half = min(each.half_x_m, each.half_y_m)
        body = self.task.situation(self.environment.physics)
        start = int(np.flatnonzero(np.isclose(self.data.qpos, body.positions_m[1, 0]))[0])
        # About the edge that stays on the table.
        away, up = half * (1 - np.cos(angle)), half * np.sin(angle)
        cos, sin = np.cos(angle / 2), np.sin(angle / 2)
        pose = [0, away, up, cos, -sin, 0, 0] if along_y else [away, 0, up, cos, 0, sin, 0]
        self.data.qpos[start : start + 7] = np.add([each.x_m, each.y_m, 0, 0, 0, 0, 0], pose)
        mujoco.mj_forward(self.model, self.data)

    def run(self, seconds: float) -> None:
        mujoco.mj_step(self.model, self.data, round(seconds / PHYSICS_TIMESTEP_S))
        mujoco.mj_forward(self.model, self.data)

    @property
    def model(self) -> mujoco.MjModel:
        return self.environment.physics.model.ptr

    @property
    def data(self) -> mujoco.MjData:
        return self.environment.physics.data.ptr

    def tilts_rad(self) -> np.ndarray:
        return self.task.tilts_rad(self.environment.physics)


TARGET = StandingObject(Kind.CAN, 0.03, 0.03, 0.12, 0.2, 0.45, -0.25, 0.0, TARGET_RGBA)
CAN = StandingObject(Kind.CAN, 0.034, 0.034, 0.17, 0.2, 0.471, 0.113, 0.0, (0, 0, 1, 1))
OBJECTS = {
    "can": CAN,
    "slender can": replace(CAN, half_x_m=0.025, half_y_m=0.025, height_m=0.24),
    "bottle": replace(CAN, kind=Kind.BOTTLE, half_x_m=0.03, half_y_m=0.03, height_m=0.22),
    "box": replace(CAN, kind=Kind.BOX, half_x_m=0.034, half_y_m=0.024, height_m=0.2),
    "box the other way": replace(CAN, kind=Kind.BOX, half_x_m=0.026, height_m=0.2),
}


@pytest.fixture(scope="module")
def table() -> Iterator[Table]:
    table = Table()
    yield table
    table.environment.close()


@pytest.mark.parametrize("difficulty", [EASY, HARD])
def test_scenes_keep_their_difficulty(difficulty):
    rng = np.random.default_rng(0)
    for _ in range(30):
        scene = draw_scene(rng, difficulty)
        target = scene.target
        assert difficulty.count[0] <= len(scene.clutter) <= difficulty.count[1]
        for kind, many in POOL.items():
            assert sum(each.kind is kind for each in scene.clutter) <= many
        for each in scene.clutter:
            away = np.hypot(each.x_m - target.x_m, each.y_m - target.y_m)
            assert away - each.reach_m - target.half_x_m >= difficulty.gap_m - 1e-9
            assert difficulty.heights_m[0] <= each.height_m <= difficulty.heights_m[1]
        # Blockers stand between the robot, at the origin, and the target.
        for each in scene.clutter[: difficulty.blockers]:
            assert np.hypot(each.x_m, each.y_m) < np.hypot(target.x_m, target.y_m)


def test_more_of_a_kind_than_the_pool_holds_is_refused(table):
    cans = [replace(CAN, x_m=0.3 + 0.1 * number) for number in range(4)]
    with pytest.raises(ParameterError, match="more than 3 objects of kind can"):
        table.lay(*cans)


def test_objects_stand_still_when_left_alone(table):
    for seed in (1, 2, 3):
        table.environment.reset(seed)
        for _ in range(100):
            transition = table.environment.step(STILL)
            assert not transition.terminated
        bodies = len(table.task.scene.objects)
        assert bodies >= 5
        # The whole pool, parked bodies included.
        turning = table.data.qvel[: 6 * 10].reshape(-1, 6)[:, 3:]
        assert np.linalg.norm(turning, axis=1).max() <= 0.01
        assert np.rad2deg(table.tilts_rad().max()) < 0.1


@pytest.mark.parametrize("name", OBJECTS)
def test_objects_fall_beyond_their_tip_angle_and_not_below(name, table):
    each = OBJECTS[name]
    for share, falls in ((0.95, False), (1.05, True)):
        table.lay(each)
        table.tilt(each, share)
        assert table.tilts_rad()[1] == pytest.approx(share * each.tip_angle_rad)
        table.run(4.0)
        assert (table.tilts_rad()[1] > 1.0) == falls
        if not falls:
            assert table.tilts_rad()[1] < 0.02


def test_nothing_of_an_earlier_scene_is_left(table):
    fresh = Table()
    for other in (table, fresh):
        if other is table:
            # Fills the pool, whose bodies the next scene leaves below the table.
            other.lay(CAN, replace(CAN, x_m=0.6), replace(OBJECTS["box"], x_m=0.3))
        other.lay(OBJECTS["bottle"])
    left, wanted = table.model, fresh.model
    for name in dir(wanted):
        array = getattr(wanted, name)
        if isinstance(array, np.ndarray):
            np.testing.assert_array_equal(getattr(left, name), array, err_msg=name)
    below = [geom for geom in range(left.ngeom) if table.data.geom_xpos[geom, 2] < -0.5]
    assert below
    assert (left.geom_rgba[below, 3] < 1e-3).all()
    fresh.environment.close()


def test_masses_are_those_that_mujoco_finds_for_the_shapes():
    each = OBJECTS["bottle"]
    parts = "".join(
        f'<geom type="cylinder" size="{part.half_x_m} {part.half_height_m}" '
        f'pos="0 0 {part.centre_m}"/>'
        for part in each.parts
    )
    text = f'<mujoco><worldbody><body name="b">{parts}<freejoint/></body></worldbody></mujoco>'
    alone = mujoco.MjModel.from_xml_string(text)
    body = alone.body("b").id
    scale = each.mass_kg / alone.body_mass[body]
    assert each.centre_of_mass_m == pytest.approx(alone.body_ipos[body, 2])
    np.testing.assert_allclose(
        np.sort(each.inertia_kg_m2), np.sort(alone.body_inertia[body] * scale), rtol=1e-6
    )


def test_toppling_ends_the_episode(table):
    table.lay(CAN)
    table.tilt(CAN, 1.0 if TOPPLING < 1 else TOPPLING)
    transition = table.environment.step(STILL)
    assert transition.terminated
    assert transition.reward == -1.0
    assert table.environment.outcome() is Outcome.FAILURE
    assert table.environment.metrics()["toppled"] == 1.0


def test_leaving_the_table_ends_the_episode(table):
    table.lay(replace(CAN, x_m=0.9))
    assert table.environment.step(STILL).terminated
    assert table.environment.outcome() is Outcome.FAILURE


def test_success_wants_the_target_up_for_half_a_second(table):
    table.lay(CAN)
    # Held up by no one: its weight is taken off.
    target = table.task.situation(table.environment.physics)
    start = int(np.flatnonzero(np.isclose(table.data.qpos, target.positions_m[0, 0]))[0])
    table.data.qpos[start + 2] = 0.11
    table.model.body_gravcomp[table.task.laid_bodies[0]] = 1.0
    for step in range(1, 11):
        transition = table.environment.step(STILL)
        assert transition.terminated == (step == 10)
    assert table.environment.outcome() is Outcome.SUCCESS
    assert table.environment.metrics()["success"] == 1.0


def test_a_divergence_is_noticed_in_any_physics_step(table, tmp_path, monkeypatch):
    # MuJoCo writes its warning to a file of the working directory.
    monkeypatch.chdir(tmp_path)
    table.environment.reset(0)
    # MuJoCo notices at the control step's first physics step, and goes on from its reset.
    table.data.qvel[0] = 1e12
    with pytest.raises(PhysicsError, match="BADQVEL"):
        table.environment.step(STILL)


def test_viewers_know_where_the_policys_cameras_are():
    environment = ComposerEnvironment(GraspTask(Scenario(cameras=("front", "wrist"))))
    environment.reset(0)
    pose = environment.pose()
    environment.close()
    cameras = pose.cameras
    front = cameras["front"]
    assert front.position_m == pytest.approx([1.15, 0, 0.62])
    assert np.rad2deg(front.fov_rad) == pytest.approx(45)
    # Towards the robot and down.
    assert upwards(front.wxyz) == pytest.approx([-0.819, 0, -0.573], abs=1e-3)
    assert pose.tool_m is not None
    assert np.linalg.norm(cameras["wrist"].position_m - pose.tool_m) < 0.3
