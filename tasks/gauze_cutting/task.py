"""Cut the printed circle out of a sheet that moves under the blade."""

from collections import OrderedDict
from collections.abc import Mapping

import mujoco
import numpy as np
from dm_control import composer, mjcf
from dm_control.composer.observation import observable
from numpy.typing import NDArray

from sheath_manip.tasks.composer_environment import SheathTask
from sheath_manip.tasks.gauze_cutting.bench import BenchArena
from sheath_manip.tasks.gauze_cutting.drawn import lines_of, surface_of
from sheath_manip.tasks.gauze_cutting.geometry import CENTRE_M, RADIUS_M
from sheath_manip.tasks.gauze_cutting.knife import Knife
from sheath_manip.tasks.gauze_cutting.posing import planar_twist
from sheath_manip.tasks.gauze_cutting.scenario import (
    CAMERA,
    CONTROL_TIMESTEP_S,
    IMAGE_PX,
    Scenario,
    spec_of,
)
from sheath_manip.tasks.gauze_cutting.scene import Scene, draw_scene
from sheath_manip.tasks.gauze_cutting.tally import Tally, metrics_of
from sheath_manip.tasks.gauze_cutting.workpiece import Workpiece
from sheath_manip.tasks.rendering import PyramidCamera
from sheath_manip.tasks.robots.drive import TWIST_SCALE, RobotDrive
from sheath_manip.tasks.robots.filtering import command_filter
from sheath_manip.tasks.robots.kinematics import twist_control
from sheath_manip.tasks.robots.placing import joints_for
from sheath_manip.tasks.robots.robot import Robot
from sheath_manip.types import Commanded, Line, Outcome, Surface

PHYSICS_TIMESTEP_S = 0.01
DEPTH_M = 0.010
"""of the tip below the clips: lower than the sheet ever sags"""
_BOX_M = (
    CENTRE_M - np.array([0.06, 0.06, DEPTH_M + 0.005]),
    CENTRE_M + np.array([0.06, 0.06, 0.2]),
)
"""for the tip: over the sheet, and up to where the arm waits"""
_PHYSICS_STEPS = round(CONTROL_TIMESTEP_S / PHYSICS_TIMESTEP_S)
_STILL_M = 5e-5
"""that a tip moves in a step without showing a heading"""


class GauzeTask(SheathTask):
    """Guide the blade around the circle until the disc is free."""

    legacy_step = False

    def __init__(self, scenario: Scenario | None = None) -> None:
        self.scenario = scenario or Scenario()
        self._arena = BenchArena()
        robot = self.scenario.robot
        self.robot = Robot(robot)
        self._arena.attach(self.robot)
        self.drive = RobotDrive(
            self.robot,
            CONTROL_TIMESTEP_S,
            command_filter(robot, CONTROL_TIMESTEP_S, box_m=_BOX_M),
        )
        # So long a step that no joint is too slow for it: inverse kinematics.
        self._placing = twist_control(robot, 1.0)
        home = np.array(robot.home_rad)
        self._rotation = self.drive.control.transform_tool_to_world(home)[:3, :3]
        middle = CENTRE_M - [0.0, 0.0, DEPTH_M]
        self._over_middle_rad = joints_for(self._placing, home, middle, self._rotation)
        self._tally = Tally()
        self._scene: Scene | None = None
        self._heading, self._velocity = np.zeros(2), np.zeros(3)
        self._steered_by = self._heading
        self.set_timesteps(CONTROL_TIMESTEP_S, PHYSICS_TIMESTEP_S)
        self._observables = OrderedDict(tool=observable.Generic(self._tool_features))
        cameras = {}
        for name in self.scenario.cameras:
            camera = PyramidCamera(name, IMAGE_PX, pyramid_levels=0)
            self._observables[name] = observable.Generic(camera)
            cameras[name] = camera.shape
        for item in self._observables.values():
            item.enabled = True
        self.spec = spec_of(self.scenario, cameras, self._arena.camera(CAMERA))

    @property
    def physics_steps_per_control_step(self) -> int:
        """One step, since composer's own loop costs a part of the physics; see `before_substep`."""
        return 1

    @property
    def root_entity(self) -> composer.Entity:
        """The bench."""
        return self._arena

    @property
    def task_observables(self) -> OrderedDict:
        """The tool's position and heading, and the cameras."""
        return self._observables

    @property
    def scene(self) -> Scene:
        """The scene of the present episode."""
        assert self._scene is not None, "the task has not been reset yet"
        return self._scene

    def after_compile(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """Bind the parts to the model."""
        self._model, self._data = physics.model.ptr, physics.data.ptr
        self.workpiece = Workpiece(self._model, self._data)
        self.knife = Knife(self.workpiece, self.spec.max_steps + 1)
        tip = physics.bind(self.robot.tool_site)
        self._tip = int(tip.element_id)
        self._knife_body = int(self._model.site_bodyid[self._tip])
        self.drive.bind(physics)
        # Composer looks at the observables before the first episode begins.
        self.lay(draw_scene(np.random.default_rng(0), self.scenario.difficulty))

    def initialize_episode(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """Draw the scene and put the blade into it."""
        rng = np.random.default_rng(random_state.randint(2**31))
        self.lay(draw_scene(rng, self.scenario.difficulty))

    def lay(self, scene: Scene) -> None:
        """Begin with `scene`; for tests and scripted starts too."""
        model, data = self._model, self._data
        self._scene = scene
        self._tally = Tally()
        self.workpiece.lay(scene)
        mujoco.mj_kinematics(model, data)
        outwards = np.array([np.cos(scene.start_rad), np.sin(scene.start_rad)])
        start = (RADIUS_M + scene.puncture_m) * outwards
        tip = self.workpiece.lie().of(start).world_m.copy()
        tip[2] = scene.centre_m[2] - DEPTH_M
        self.place_tip(tip)
        mujoco.mj_kinematics(model, data)
        self.knife.put_in(start, self.tip_m, data)
        # Counter-clockwise along the line.
        self._heading = scene.rotation @ [-outwards[1], outwards[0]]
        self._velocity = np.zeros(3)
        self.workpiece.park_spares()
        data.qfrc_applied[:] = 0.0
        mujoco.mj_fwdPosition(model, data)

    def place_tip(self, position_m: NDArray) -> None:
        """Put the arm at rest with the blade's tip at (3,) in the world, upright."""
        joints = joints_for(self._placing, self._over_middle_rad, position_m, self._rotation)
        self.drive.place(joints)

    @staticmethod
    def rest() -> NDArray[np.float32]:
        """(2,) the action that leaves the blade where it is."""
        return np.zeros(2, np.float32)

    @property
    def tip_m(self) -> NDArray[np.float64]:
        """The (3,) tip of the blade, world frame."""
        return self._data.site_xpos[self._tip].copy()

    @property
    def heading(self) -> NDArray[np.float64]:
        """(2,) of length 1: which way the blade has moved last, world frame."""
        return self._heading

    @property
    def tip_velocity_m_s(self) -> NDArray[np.float64]:
        """The (3,) velocity of the blade's tip in the last control step, world frame."""
        return self._velocity

    def before_step(self, physics: mjcf.Physics, action: NDArray, random_state) -> None:  # noqa: ARG002
        """Command the arm, and let the blade's friction act on it and on the sheet."""
        velocity = self.scenario.steering.velocity_m_s(action, self._heading)
        self._steered_by = self._heading
        height = self.scene.centre_m[2] - DEPTH_M
        pose = self.drive.commanded_tool_pose()
        twist = planar_twist(velocity, pose, height, self._rotation) / TWIST_SCALE
        self.drive.command(np.concatenate([twist, [0.0]]))
        model, data = self._model, self._data
        data.qfrc_applied[:] = 0.0
        held, drag = self.knife.held_vertices(), self.knife.drag_n
        columns = self.workpiece.sheet.dofs[held][:, None] + np.arange(3)
        data.qfrc_applied[columns] = drag / len(held)
        mujoco.mj_applyFT(
            model, data, -drag, np.zeros(3), self.tip_m, self._knife_body, data.qfrc_applied
        )

    def before_substep(self, physics: mjcf.Physics, action: NDArray, random_state) -> None:  # noqa: ARG002
        """Run all physics steps but the one that composer makes."""
        for _ in range(_PHYSICS_STEPS - 1):
            self.workpiece.move_clips(self._data.time)
            mujoco.mj_step(self._model, self._data)
        self.workpiece.move_clips(self._data.time)

    def after_step(self, physics: mjcf.Physics, random_state) -> None:  # noqa: ARG002
        """Cut, and judge."""
        model, data = self._model, self._data
        # A step leaves the bodies where they were before its last integration.
        self.workpiece.park_spares()
        mujoco.mj_kinematics(model, data)
        tip, before = self.tip_m, self.knife.crack.cuts
        self._turn(tip - self.knife.tip_m)
        lie = self.knife.move(tip, data, self.scene.drag_n, CONTROL_TIMESTEP_S)
        mujoco.mj_comPos(model, data)
        mujoco.mj_camlight(model, data)
        mujoco.mj_flex(model, data)
        tally = self._tally
        tally.strain = max(tally.strain, self.workpiece.largest_strain(lie))
        if len(self.knife.crack.cuts) > len(before):
            tally.freed = self.workpiece.disc() is not None
            if tally.freed:
                self.workpiece.let_go()
        astray = abs(float(np.linalg.norm(self.knife.path_m[-1])) - RADIUS_M)
        tally.judge(astray, self.knife.exhausted)

    def get_reward(self, physics: mjcf.Physics) -> float:  # noqa: ARG002
        """-1 for a failure, 0 otherwise: learning from demonstrations needs no reward."""
        return -1.0 if self._tally.outcome is Outcome.FAILURE else 0.0

    def outcome(self) -> Outcome:
        """SUCCESS once the disc is free.

        FAILURE where the sheet tears, the blade strays from the line, or there are no spares left.
        """
        return self._tally.outcome

    def metrics(self) -> Mapping[str, float]:
        """Return what has been cut, how near to the line, and how roughly."""
        return metrics_of(self._tally, self.knife, self.workpiece)

    def memory(self) -> NDArray[np.float64]:
        """(m,) the tally, the heading, what knife and drive remember."""
        tally = self._tally
        return np.array(
            [
                list(Outcome).index(tally.outcome),
                tally.strain,
                tally.freed,
                *self._heading,
                *self._velocity,
                *self.drive.memory(),
                *self.knife.memory(),
            ]
        )

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take over a `memory()`."""
        outcome, strain, freed = memory[:3]
        self._tally = Tally(list(Outcome)[int(outcome)], float(strain), bool(freed))
        self._heading = memory[3:5].copy()
        self._velocity = memory[5:8].copy()
        end = 8 + len(self.drive.memory())
        self.drive.recall(memory[8:end])
        self.workpiece.make_whole()
        self.knife.recall(memory[end:])
        if self._tally.freed:
            self.workpiece.let_go()

    def tool_m(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        """(3,) the blade's tip."""
        return physics.data.ptr.site_xpos[self._tip].copy()

    def surfaces(self, physics: mjcf.Physics) -> tuple[Surface, ...]:  # noqa: ARG002
        """The sheet, with its cut."""
        return (surface_of(self.workpiece.sheet, self.workpiece.lie()),)

    def lines(self, physics: mjcf.Physics) -> tuple[Line, ...]:  # noqa: ARG002
        """The circle on the sheet, and the way of the blade so far."""
        return lines_of(self.workpiece.lie(), self.knife.path_m)

    def commanded(self) -> Commanded | None:
        """Return what the command filter made of the last action."""
        of_arm = self.drive.commanded
        if of_arm is None:
            return None
        velocity = of_arm.action[:2] * TWIST_SCALE[:2]
        executed = self.scenario.steering.action_for(velocity, self._steered_by)
        return Commanded(executed, of_arm.limited)

    def _turn(self, moved_m: NDArray) -> None:
        """Note how the tip has moved; the heading follows it."""
        self._velocity = moved_m / CONTROL_TIMESTEP_S
        length = float(np.linalg.norm(moved_m[:2]))
        if length > _STILL_M:
            self._heading = moved_m[:2] / length

    def _tool_features(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        return np.concatenate([physics.data.ptr.site_xpos[self._tip], self._heading])
