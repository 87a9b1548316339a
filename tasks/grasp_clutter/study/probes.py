"""States that the grasp's expert does not come to, and its regret of an action.

What is displaced is the arm; the objects stay where they are, also one that was held.
"""

from functools import partial

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.twist_control import twist_between
from sheath_manip.experiments.probes import Displacement, Probes
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.tasks.grasp_clutter.task import CONTROL_TIMESTEP_S, GraspTask
from sheath_manip.tasks.robots.drive import RobotDrive
from sheath_manip.types import Action, Observation

HORIZON_STEPS = 10
"""for which an action is held to see what becomes of it: half a second"""
COSTLY_LEAN = 0.15
"""of what counts as toppled: touched lightly an object leans by less than a tenth"""
_SOLVER_STEPS = 60
"""of a control step each, within which the arm gets to any of the displacements"""


def aside(distance_m: float, environment: ComposerEnvironment, rng: np.random.Generator):
    """Move the tool sideways, in any direction, at its height and as it points."""
    angle = rng.uniform(-np.pi, np.pi)
    shift_m = distance_m * np.array([np.cos(angle), np.sin(angle), 0.0])
    return _displaced(environment, shift_m, np.zeros(3))


def turned(angle_deg: float, environment: ComposerEnvironment, rng: np.random.Generator):
    """Turn the jaw about the vertical, either way."""
    turn = rng.choice([-1.0, 1.0]) * np.deg2rad(angle_deg)
    return _displaced(environment, np.zeros(3), np.array([0.0, 0.0, turn]))


def tilted(angle_deg: float, environment: ComposerEnvironment, rng: np.random.Generator):
    """Tilt the tool about a horizontal axis: the expert's points down, nearly."""
    angle = rng.uniform(-np.pi, np.pi)
    axis = np.array([np.cos(angle), np.sin(angle), 0.0])
    return _displaced(environment, np.zeros(3), np.deg2rad(angle_deg) * axis)


def half_closed(environment: ComposerEnvironment, rng: np.random.Generator) -> Observation:
    """Close the jaw half-way, wherever it is."""
    del rng
    task = _task(environment)
    task.drive.place_gripper(task.scenario.robot.opening_m / 2)
    environment.physics.forward()
    return environment.observe()


def regret(expert: GraspExpert, action: Action) -> float:
    """How much farther an object leans once (7,) `action` has been held for half a second.

    As a share of what counts as toppled, of the object that it does most to.
    """
    environment = expert.environment
    task, physics = _task(environment), environment.physics
    state, before = environment.state(), task.leans(physics)[1:]
    most = 0.0
    for _ in range(HORIZON_STEPS):
        task.before_step(physics, action, None)
        mujoco.mj_kinematics(physics.model.ptr, physics.data.ptr)
        most = max(most, float((task.leans(physics)[1:] - before).max()))
    environment.restore(state)
    return most


PROBES = Probes(
    displacements=(
        # Above the clutter the expert may be anywhere, and turned as the scene wants it.
        *(
            Displacement(f"aside {distance_m * 100:g} cm", partial(aside, distance_m), far=False)
            for distance_m in (0.02, 0.04)
        ),
        Displacement("turned 45°", partial(turned, 45.0), far=False),
        # As it is when it closes.
        Displacement("jaw half closed", half_closed, far=False),
        *(
            Displacement(f"tilted {angle_deg:g}°", partial(tilted, angle_deg))
            for angle_deg in (15.0, 30.0)
        ),
    ),
    regret=regret,
    costly_regret=COSTLY_LEAN,
)


def _displaced(
    environment: ComposerEnvironment, shift_m: NDArray, turn_rad: NDArray
) -> Observation:
    """Look from where the tool is moved by (3,) and turned by the rotation vector (3,)."""
    drive = _task(environment).drive
    drive.place_arm(_reached(drive, shift_m, turn_rad))
    environment.physics.forward()
    return environment.observe()


def _reached(drive: RobotDrive, shift_m: NDArray, turn_rad: NDArray) -> NDArray[np.float64]:
    """(j,) joints of the displaced tool, as near as the arm's joints allow."""
    control, joints = drive.control, drive.positions_rad().copy()
    goal = control.transform_tool_to_world(joints)
    goal[:3, 3] += shift_m
    goal[:3, :3] = _rotation(turn_rad) @ goal[:3, :3]
    for _ in range(_SOLVER_STEPS):
        now = control.transform_tool_to_world(joints)
        joints = control.joint_targets(joints, twist_between(now, goal, CONTROL_TIMESTEP_S))
    return joints


def _rotation(turn_rad: NDArray) -> NDArray[np.float64]:
    """(3, 3) of a rotation vector."""
    angle = float(np.linalg.norm(turn_rad))
    quaternion, matrix = np.zeros(4), np.zeros(9)
    axis = turn_rad / angle if angle > 0 else np.array([0.0, 0.0, 1.0])
    mujoco.mju_axisAngle2Quat(quaternion, axis, angle)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


def _task(environment: ComposerEnvironment) -> GraspTask:
    if not isinstance(environment.task, GraspTask):
        raise TypeError(f"the grasp's probes want a GraspTask, got {environment.task!r}")
    return environment.task
