"""Grasp the red target among standing objects and lift it; nothing may fall over."""

import math
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass

import mujoco
import numpy as np
from dm_control import composer, mjcf
from dm_control.composer.observation import observable
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.composer_environment import SheathTask
from sheath_manip.tasks.grasp_clutter.arena import TableArena
from sheath_manip.tasks.grasp_clutter.guide import WIDE_M, GraspGuide, Situation
from sheath_manip.tasks.grasp_clutter.mirroring import mirror_of
from sheath_manip.tasks.grasp_clutter.pool import Pool
from sheath_manip.tasks.grasp_clutter.rehearsal import solvable
from sheath_manip.tasks.grasp_clutter.scene import (
    HARD,
    TABLE_X_M,
    TABLE_Y_M,
    Difficulty,
    Scene,
    draw_scene,
)
from sheath_manip.tasks.grasp_clutter.tally import Tally
from sheath_manip.tasks.rendering import PyramidCamera
from sheath_manip.tasks.robots.drive import ACTION, RobotDrive
from sheath_manip.tasks.robots.filtering import command_filter
from sheath_manip.tasks.robots.motions import said
from sheath_manip.tasks.robots.own_arm import ARM_WITH_JAW
from sheath_manip.tasks.robots.robot import Robot, RobotDescription
from sheath_manip.types import Commanded, FirstView, Outcome, TaskSpec

CONTROL_TIMESTEP_S = 0.05
PHYSICS_TIMESTEP_S = 0.0025
IMAGE_PX = 84
TOPPLING = 0.9
"""share of its own tip angle from which an object counts as toppled"""
LIFTED_M = 0.10
LIFTED_STEPS = 10
"""for which the target must be up: half a second"""
_TABLE_LOWER_M, _TABLE_UPPER_M = np.transpose([TABLE_X_M, TABLE_Y_M])
_PHYSICS_STEPS = round(CONTROL_TIMESTEP_S / PHYSICS_TIMESTEP_S)
_MOST_DRAWS = 999
"""of scenes, until one can be solved"""
_START_SPREAD_RAD = 0.06
"""of the arm's joints, about where it waits"""


@dataclass(frozen=True)
class Scenario:
    """A scenario: what a variant of the task may change."""

    difficulty: Difficulty = HARD
    robot: RobotDescription = ARM_WITH_JAW
    cameras: tuple[str, ...] = ("front", "wrist")
    """`shoulder` beside them looks from the side: with it there is no mirror image of a scene"""
    time_limit_s: float = 15.0
    command_filter: bool = True
    """without one the arm does whatever it is told"""


class GraspTask(SheathTask):
    """Reach through the clutter, grasp the target, lift it."""

    legacy_step = False

    def __init__(self, scenario: Scenario | None = None) -> None:
        self.scenario = scenario or Scenario()
        self._arena = TableArena()
        self.robot = Robot(self.scenario.robot)
        self._arena.attach(self.robot)
        self.drive = RobotDrive(
            self.robot,
            CONTROL_TIMESTEP_S,
            command_filter(self.scenario.robot, CONTROL_TIMESTEP_S)
            if self.scenario.command_filter
            else None,
        )
        self._guide = GraspGuide(self.scenario.robot, CONTROL_TIMESTEP_S, WIDE_M)
        self._tally = Tally()
        self._scene: Scene | None = None
        self.laid_bodies = np.zeros(0, np.int64)
        """(n,) of the scene's objects in the model, the target's first"""
        self.draws = 0
        """how many scenes have been drawn until one could be solved, this episode's included"""
        self.set_timesteps(CONTROL_TIMESTEP_S, PHYSICS_TIMESTEP_S)
        joints = self.scenario.robot.joint_speeds_rad_s
        self._observables = OrderedDict(proprioception=observable.Generic(self._proprioception))
        cameras = {}
        for name in self.scenario.cameras:
            camera = PyramidCamera(self.camera_name(name), IMAGE_PX, pyramid_levels=0)
            self._observables[name] = observable.Generic(camera)
            cameras[name] = camera.shape
        for item in self._observables.values():
            item.enabled = True
        self.spec = TaskSpec(
            name="grasp-clutter",
            control_rate_hz=1 / CONTROL_TIMESTEP_S,
            action=ACTION,
            cameras=cameras,
            feature_names=(
                *(f"{name}_rad" for name in joints),
                *(f"tool_{axis}_m" for axis in "xyz"),
                "closed_m",
                "pressed_m",
            ),
            max_steps=round(self.scenario.time_limit_s / CONTROL_TIMESTEP_S),
            metric="success",
            plane=("tool_x_m", "tool_y_m"),
            first_view=FirstView(0.55, azimuth_deg=145.0, elevation_deg=25.0),
            mirror=mirror_of(self.scenario.robot, self.scenario.cameras),
        )

    @property
    def physics_steps_per_control_step(self) -> int:
        """Zero: composer's own loop costs a quarter of the physics; see `before_step`."""
        return 0

    @property
    def root_entity(self) -> composer.Entity:
        """The arena."""
        return self._arena

    @property
    def task_observables(self) -> OrderedDict:
        """Joints, tool and gripper as features, and the cameras."""
        return self._observables

    @property
    def scene(self) -> Scene:
        """The scene of the present episode."""
        assert self._scene is not None, "the task has not been reset yet"
        return self._scene

    def after_compile(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """Bind the parts to the model."""
        self._pool = Pool(physics.model.ptr)
        self._tool = physics.bind(self.robot.tool_site).element_id
        self.drive.bind(physics)

    def initialize_episode(self, physics: mjcf.Physics, random_state) -> None:
        """Draw scenes until one can be solved from where the arm starts."""
        rng = np.random.default_rng(random_state.randint(2**31))
        start = self._start(rng)
        for self.draws in range(1, _MOST_DRAWS + 1):
            scene = draw_scene(rng, self.scenario.difficulty)
            if solvable(self._guide, scene, start):
                self.lay(physics, scene, start)
                return
        remark = said(self.scenario.robot)
        raise ParameterError(
            f"none of {_MOST_DRAWS} scenes can be solved by this robot"
            + ("" if remark is None else f": {remark}")
            + "; wanted one that reaches 0.38 to 0.54 m far with its tool pointing down"
        )

    def lay(self, physics: mjcf.Physics, scene: Scene, start_rad: NDArray) -> None:
        """Begin with `scene` and the arm at (j,) `start_rad`; for tests and scripted starts too."""
        self._scene = scene
        self._tally = Tally()
        self._toppling_rad = TOPPLING * np.array([each.tip_angle_rad for each in scene.objects])
        self._pool.shape(scene)
        self._pool.place(physics.data.ptr, scene)
        self.laid_bodies = self._pool.laid_bodies
        self.drive.place(start_rad)
        mujoco.mj_forward(physics.model.ptr, physics.data.ptr)
        self._tool_m = physics.data.ptr.site_xpos[self._tool].copy()
        self._momenta = self._pool.momenta(physics.data.ptr)

    def tool_m(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        """(3,) the middle between the fingers."""
        return physics.data.ptr.site_xpos[self._tool].copy()

    def situation(self, physics: mjcf.Physics) -> Situation:
        """Robot and objects as they are."""
        data, bodies = physics.data.ptr, self.laid_bodies
        return Situation(
            joint_targets_rad=self.drive.targets_rad(),
            closed_m=self.drive.closed_m(),
            pressed_m=self.drive.pressed_m(),
            positions_m=data.xpos[bodies],
            wxyz=data.xquat[bodies],
            rotations=data.xmat[bodies].reshape(-1, 3, 3),
        )

    def tilts_rad(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        """Return the (n,) tilts of the scene's objects from upright, the target's first."""
        return np.arccos(physics.data.ptr.xmat[self.laid_bodies, 8].clip(-1.0, 1.0))

    def leans(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        """(n,) those tilts, each as a share of what counts as toppled."""
        return self.tilts_rad(physics) / self._toppling_rad

    def before_step(self, physics: mjcf.Physics, action: NDArray, random_state) -> None:  # noqa: ARG002
        """Command the arm, and make all physics steps at once."""
        self.drive.command(action)
        physics.step(_PHYSICS_STEPS)

    def after_step(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """Judge."""
        model, data = physics.model.ptr, physics.data.ptr
        # A step leaves the bodies where they were before its last integration.
        mujoco.mj_kinematics(model, data)
        mujoco.mj_camlight(model, data)
        tally = self._tally
        tilts = self.tilts_rad(physics)
        tally.tilt_rad = max(tally.tilt_rad, float(tilts.max()))
        positions = data.xpos[self.laid_bodies]
        places = positions[:, :2]
        inside = ((places > _TABLE_LOWER_M) & (places < _TABLE_UPPER_M)).all(axis=1)
        fallen = (tilts > self._toppling_rad) | ~inside
        tally.toppled = max(tally.toppled, int(np.count_nonzero(fallen)))
        before_m, self._tool_m = self._tool_m, data.site_xpos[self._tool].copy()
        tally.path_m += math.dist(before_m, self._tool_m)
        before, self._momenta = self._momenta, self._pool.momenta(data)
        squares = ((self._momenta - before)[1:] ** 2).sum(axis=1)
        tally.impulse_n_s = max(tally.impulse_n_s, float(squares.max()) ** 0.5)
        tally.lifted_steps = tally.lifted_steps + 1 if positions[0, 2] > LIFTED_M else 0
        if tally.toppled:
            tally.outcome = Outcome.FAILURE
        elif tally.lifted_steps >= LIFTED_STEPS:
            tally.outcome = Outcome.SUCCESS

    def get_reward(self, physics: mjcf.Physics) -> float:  # noqa: ARG002
        """-1 for a failure, 0 otherwise: learning from demonstrations needs no reward."""
        return -1.0 if self._tally.outcome is Outcome.FAILURE else 0.0

    def outcome(self) -> Outcome:
        """FAILURE once an object has toppled or left the table, SUCCESS once the target is up."""
        return self._tally.outcome

    def metrics(self) -> Mapping[str, float]:
        """Success, what toppled, and how roughly it went."""
        tally = self._tally
        return {
            "success": float(tally.outcome is Outcome.SUCCESS),
            "toppled": float(tally.toppled),
            "tilt_deg": float(np.rad2deg(tally.tilt_rad)),
            "path_m": tally.path_m,
            "impulse_n_s": tally.impulse_n_s,
        }

    def memory(self) -> NDArray[np.float64]:
        """(m,) the tally, where the tool was, the momenta of the pool, what the drive remembers."""
        tally = self._tally
        figures = (
            list(Outcome).index(tally.outcome),
            tally.lifted_steps,
            tally.toppled,
            tally.tilt_rad,
            tally.path_m,
            tally.impulse_n_s,
        )
        return np.concatenate([figures, self._tool_m, self._momenta.ravel(), self.drive.memory()])

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take over a `memory()`."""
        outcome, lifted, toppled, tilt, path, impulse = memory[:6]
        self._tally = Tally(
            list(Outcome)[int(outcome)],
            int(lifted),
            int(toppled),
            float(tilt),
            float(path),
            float(impulse),
        )
        self._tool_m = memory[6:9].copy()
        end = 9 + self._momenta.size
        self._momenta = memory[9:end].reshape(-1, 3).copy()
        self.drive.recall(memory[end:])

    def commanded(self) -> Commanded | None:
        """Return what the command filter made of the last action."""
        return self.drive.commanded

    def _proprioception(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        tool = physics.data.ptr.site_xpos[self._tool]
        gripper = [self.drive.closed_m(), self.drive.pressed_m()]
        return np.concatenate([self.drive.positions_rad(), tool, gripper])

    def _start(self, rng: np.random.Generator) -> NDArray[np.float64]:
        home = np.array(self.scenario.robot.home_rad)
        return home + rng.uniform(-_START_SPREAD_RAD, _START_SPREAD_RAD, len(home))

    def camera_name(self, name: str) -> str:
        """Return the model's name of the camera that observations call `name`."""
        if name in ("front", "shoulder"):
            return name
        camera = next(
            each for each in self.robot.mjcf_model.find_all("camera") if each.name == name
        )
        return camera.full_identifier
