"""Runs a robot in its scene by the action that policy, expert and person share."""

import mujoco
import numpy as np
from dm_control import mjcf
from numpy.typing import NDArray

from sheath_manip.controllers.closing_control import ClosingControl
from sheath_manip.controllers.command_filter import CommandFilter
from sheath_manip.controllers.twist_control import twist_between
from sheath_manip.tasks.robots.kinematics import twist_control
from sheath_manip.tasks.robots.robot import Robot
from sheath_manip.types import Action, ActionSpec, Commanded, Limited

TOP_SPEED_M_S = 0.25
TOP_TURN_RAD_S = 1.5
TWIST_SCALE = np.array([TOP_SPEED_M_S] * 3 + [TOP_TURN_RAD_S] * 3)
"""(6,) the twist (m/s, rad/s, world frame) that an action of ones commands"""
LEAD_RAD = 0.12
"""how far a joint's target may lead the joint: an arm that something holds back must not store the
way that it could not go"""

ACTION = ActionSpec(
    names=(*(f"{kind}_{axis}" for kind in ("velocity", "turn") for axis in "xyz"), "grip"),
    minimum=-np.ones(7, np.float32),
    maximum=np.ones(7, np.float32),
    tolerance=0.1,
)
"""velocity and angular velocity of the tool in the world frame as shares of `TWIST_SCALE`; grip -1
opens and 1 closes"""
REACH = "reach"
"""what was taken off because the joints cannot move the tool as wished, or are held back"""
_REACH_TOLERANCE = 0.02
"""share of the fastest command; the posture that a twist leaves open costs less"""


class RobotDrive:
    """Turns an action into the servos' rates for one control step.

    It remembers nothing but the command filter, which may be None for an arm without one.
    """

    def __init__(
        self, robot: Robot, timestep_s: float, command_filter: CommandFilter | None
    ) -> None:
        self.command_filter = command_filter
        self.commanded: Commanded | None = None
        """what became of the last action; None without a filter"""
        self._robot = robot
        self._timestep_s = timestep_s
        self.control = twist_control(robot.description, timestep_s)
        self._closing = ClosingControl(robot.description.opening_m)
        self._coupling = robot.description.coupling

    def bind(self, physics: mjcf.Physics) -> None:
        """Take note of where the robot is in a newly compiled model."""
        robot, model = self._robot, physics.model.ptr
        self._data: mujoco.MjData = physics.data.ptr
        # Indices once: dm_control's bindings cost more at each access than the kinematics.
        joints = np.atleast_1d(physics.bind(robot.joints).element_id)
        self._qpos, self._qvel = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self._servos = np.atleast_1d(physics.bind(robot.servos).element_id)
        self._targets = model.actuator_actadr[self._servos]
        if robot.closing_servo is not None:
            fingers = np.atleast_1d(physics.bind(robot.closing_joints).element_id)
            self._signs = np.array(robot.description.closing_signs[: len(fingers)])
            self._finger_qpos, self._finger_qvel = (
                model.jnt_qposadr[fingers],
                model.jnt_dofadr[fingers],
            )
            self._closing_servo = int(physics.bind(robot.closing_servo).element_id)
            self._closing_target = int(model.actuator_actadr[self._closing_servo])

    def positions_rad(self) -> NDArray[np.float64]:
        """Return the (j,) positions of the arm's joints."""
        return self._data.qpos[self._qpos]

    def targets_rad(self) -> NDArray[np.float64]:
        """Return the (j,) targets of the arm's servos, from which the next command starts."""
        positions = self.positions_rad()
        targets = np.maximum(self._data.act[self._targets], positions - LEAD_RAD)
        return np.minimum(targets, positions + LEAD_RAD)

    def closed_m(self) -> float:
        """Return how far the gripper is closed."""
        coordinate = float((self._signs * self._data.qpos[self._finger_qpos]).sum())
        return self._coupling.closed_m(coordinate)

    def pressed_m(self) -> float:
        """Return how much farther the servo wants to close the gripper."""
        return self._target_m() - self.closed_m()

    def command(self, action: NDArray) -> None:
        """Set the rates for (7,) `action`."""
        data, timestep_s = self._data, self._timestep_s
        action = np.asarray(action, np.float64)
        wanted = self.control.joint_targets(self.targets_rad(), action[:6] * TWIST_SCALE)
        if self.command_filter is not None:
            wanted = self._filtered(action, wanted, self.command_filter)
        data.ctrl[self._servos] = (wanted - data.act[self._targets]) / timestep_s
        if self._robot.closing_servo is not None:
            now, closed_m = self._target_m(), self.closed_m()
            wish = self._closing.target_m(now, closed_m, float(action[6]), timestep_s)
            way = self._coupling.coordinate(wish) - float(data.act[self._closing_target])
            data.ctrl[self._closing_servo] = way / timestep_s

    def rest(self) -> Action:
        """(7,) the action that leaves arm and gripper as they are."""
        action = np.zeros(7, np.float32)
        if self._robot.closing_servo is not None:
            # The target and not the fingers: what is held is pressed on.
            action[6] = self._closing.holding_grip(self._target_m())
        return action

    def commanded_tool_pose(self) -> NDArray[np.float64]:
        """Return the (4, 4) pose of the tool, world frame, with the joints at their targets."""
        return self.control.transform_tool_to_world(self._data.act[self._targets])

    def place(self, positions_rad: NDArray) -> None:
        """Put the arm at rest at (j,) `positions_rad`, its gripper open."""
        self.place_arm(positions_rad)
        if self._robot.closing_servo is not None:
            self.place_gripper(0.0)

    def place_arm(self, positions_rad: NDArray) -> None:
        """Put the arm alone at rest at (j,) `positions_rad`."""
        data = self._data
        if self.command_filter is not None:
            self.command_filter.reset(positions_rad)
        data.qpos[self._qpos] = data.act[self._targets] = positions_rad
        data.qvel[self._qvel] = data.ctrl[self._servos] = 0.0

    def place_gripper(self, closed_m: float) -> None:
        """Close the gripper by that much, at rest and without pressing."""
        data = self._data
        coordinate = self._coupling.coordinate(closed_m)
        data.qpos[self._finger_qpos] = self._signs * (coordinate / len(self._finger_qpos))
        data.qvel[self._finger_qvel] = data.ctrl[self._closing_servo] = 0.0
        data.act[self._closing_target] = coordinate

    def memory(self) -> NDArray[np.float64]:
        """Return the (m,) memory of the command filter."""
        return np.zeros(0) if self.command_filter is None else self.command_filter.memory()

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take over a `memory()`."""
        if self.command_filter is not None:
            self.command_filter.recall(memory)

    def _target_m(self) -> float:
        """How far the servo of the gripper wants it closed."""
        return self._coupling.closed_m(float(self._data.act[self._closing_target]))

    def _filtered(
        self, action: NDArray, wanted_rad: NDArray, command_filter: CommandFilter
    ) -> NDArray[np.float64]:
        """(j,) what the filter makes of the joint targets, and a note of it."""
        before = self.control.transform_tool_to_world(command_filter.targets_rad)
        reached = self._shares(before, wanted_rad)
        missed = float(np.abs(reached - action[:6]).max())
        admitted = command_filter.step(wanted_rad)
        limited = admitted.limited
        if missed > _REACH_TOLERANCE:
            limited = tuple(sorted((*limited, Limited(REACH, missed))))
        executed = action.astype(np.float32)
        if limited:
            executed[:6] = self._shares(before, admitted.targets_rad)
        self.commanded = Commanded(executed, limited)
        return admitted.targets_rad

    def _shares(self, before: NDArray, targets_rad: NDArray) -> NDArray[np.float64]:
        """(6,) of `TWIST_SCALE`: how the tool moves from a pose to that of (j,) `targets_rad`."""
        after = self.control.transform_tool_to_world(targets_rad)
        return twist_between(before, after, self._timestep_s) / TWIST_SCALE
