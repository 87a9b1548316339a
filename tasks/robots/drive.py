"""Runs a robot in its scene by the action that policy, expert and person share."""

import numpy as np
from dm_control import mjcf
from numpy.typing import NDArray

from controllers.closing_control import ClosingControl
from sheath_manip.types import ActionSpec
from tasks.robots.robot import Robot, twist_control

TOP_SPEED_M_S = 0.25
TOP_TURN_RAD_S = 1.5
TWIST_SCALE = np.array([TOP_SPEED_M_S] * 3 + [TOP_TURN_RAD_S] * 3)
"""(6,) the twist (m/s, rad/s, world frame) that an action of ones commands"""
_LEAD_RAD = 0.12
"""how far a joint's target may lead the joint: an arm that something holds back must not store the
way that it could not go"""

ACTION = ActionSpec(
    names=(*(f"{kind}_{axis}" for kind in ("velocity", "turn") for axis in "xyz"), "grip"),
    minimum=-np.ones(7, np.float32),
    maximum=np.ones(7, np.float32),
)
"""velocity and angular velocity of the tool in the world frame as shares of `TWIST_SCALE`; grip -1
opens and 1 closes"""


class RobotDrive:
    """Turns an action into the servos' rates for one control step. It remembers nothing."""

    def __init__(self, robot: Robot, timestep_s: float) -> None:
        self._robot = robot
        self._timestep_s = timestep_s
        self.control = twist_control(robot.description, timestep_s)
        self._closing = ClosingControl(robot.description.opening_m)

    def command(self, physics: mjcf.Physics, action: NDArray) -> None:
        """Set the rates for (7,) `action`."""
        robot = self._robot
        action = np.asarray(action, np.float64)
        positions = robot.joint_positions(physics)
        targets = np.array(physics.bind(robot.servos).act)
        start = np.clip(targets, positions - _LEAD_RAD, positions + _LEAD_RAD)
        wanted = self.control.joint_targets(start, action[:6] * TWIST_SCALE)
        physics.bind(robot.servos).ctrl = (wanted - targets) / self._timestep_s
        if robot.closing_servo is not None:
            servo = physics.bind(robot.closing_servo)
            now = float(servo.act)
            closed = float(np.sum(physics.bind(robot.closing_joints).qpos))
            wish = self._closing.target_m(now, closed, action[6], self._timestep_s)
            servo.ctrl = (wish - now) / self._timestep_s

    def place(self, physics: mjcf.Physics, positions_rad: NDArray) -> None:
        """Put the arm at rest at (j,) `positions_rad`, its gripper open."""
        robot = self._robot
        physics.bind(robot.joints).qpos = positions_rad
        physics.bind(robot.joints).qvel = 0.0
        physics.bind(robot.servos).act = positions_rad
        physics.bind(robot.servos).ctrl = 0.0
        if robot.closing_servo is not None:
            physics.bind(robot.closing_joints).qpos = 0.0
            physics.bind(robot.closing_joints).qvel = 0.0
            physics.bind(robot.closing_servo).act = 0.0
            physics.bind(robot.closing_servo).ctrl = 0.0
