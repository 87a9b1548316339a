"""Turns a twist of the tool into joint targets, by differential inverse kinematics (mink)."""

from collections.abc import Mapping, Sequence
from ctypes import c_int

import daqp
import mink
import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError

_POSTURE_COST = 1e-3
"""settles what the twist leaves open, next to a singularity, without pulling at the tool"""
_DAMPING = 1e-6
_RANGE_GAIN = 0.95
"""share of what is left of a joint's range that one step may use up, as in mink's limits"""


class TwistControl:
    """Moves the tool as commanded, as far as the joints' ranges and speeds allow.

    It remembers nothing: the joints' targets, which the arm's servos hold, go in and come out.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        tool_site: str,
        joint_speeds_rad_s: Mapping[str, float],
        home_rad: Sequence[float],
        timestep_s: float,
    ) -> None:
        """Take an arm whose joints are the only ones of its `model`.

        `joint_speeds_rad_s` names its joints, all of `model`, in order, with their top speeds;
        `home_rad` is the posture preferred where a twist leaves a choice. Raises ParameterError.
        """
        names = [model.joint(index).name for index in range(model.njnt)]
        if names != list(joint_speeds_rad_s) or model.nq != len(home_rad):
            raise ParameterError(
                f"joints {list(joint_speeds_rad_s)} with {len(home_rad)} home angles; "
                f"the model has {names} and must have the arm's joints alone, all hinges"
            )
        self.model = model
        self.timestep_s = timestep_s
        self.configuration = mink.Configuration(model)
        self._site = int(model.site(tool_site).id)
        self._tool = mink.FrameTask(tool_site, "site", position_cost=1.0, orientation_cost=0.3)
        self._home_rad = np.array(home_rad, float)
        self._own_hessian = (_POSTURE_COST**2 + _DAMPING) * np.eye(model.nv)
        self._no_rows = np.zeros((0, model.nv))
        self._steps_rad = np.array(list(joint_speeds_rad_s.values()), float) * timestep_s
        self.further_limits: tuple[mink.Limit, ...] = ()
        """beside the joints' ranges and speeds"""
        limited = model.jnt_limited.astype(bool)
        self.lower_rad = np.where(limited, model.jnt_range[:, 0], -np.inf)
        self.upper_rad = np.where(limited, model.jnt_range[:, 1], np.inf)

    def transform_tool_to_world(self, positions_rad: NDArray) -> NDArray[np.float64]:
        """(4, 4) pose of the tool (m) with the joints at (j,) `positions_rad`."""
        data = self.configuration.data
        data.qpos[:] = self._inside(positions_rad)
        mujoco.mj_kinematics(self.model, data)
        pose = np.eye(4)
        pose[:3, :3] = data.site_xmat[self._site].reshape(3, 3)
        pose[:3, 3] = data.site_xpos[self._site]
        return pose

    def joint_targets(self, targets_rad: NDArray, twist: NDArray) -> NDArray[np.float64]:
        """(j,) the joints' targets (rad) at the end of a control step that starts with theirs.

        `twist` is (6,): velocity of the tool (m/s) and angular velocity (rad/s), both in the world
        frame. Where no motion is admissible the targets stay.
        """
        twist = np.asarray(twist, np.float64)
        if twist.shape != (6,) or not np.isfinite(twist).all():
            raise ParameterError(f"twist {twist.tolist()}; wanted 6 finite numbers, m/s and rad/s")
        positions = self._inside(targets_rad)
        self.configuration.update(positions)
        self._tool.set_target(self._moved(twist))
        step = self._solved(positions)
        return positions if step is None else positions + step

    def _moved(self, twist: NDArray) -> mink.SE3:
        """Where `twist` takes the tool in a control step from where the configuration has it."""
        data, pose, turn = self.configuration.data, np.empty(7), np.array([1.0, 0.0, 0.0, 0.0])
        mujoco.mju_mat2Quat(pose[:4], data.site_xmat[self._site])
        mujoco.mju_quatIntegrate(turn, twist[3:], self.timestep_s)
        mujoco.mju_mulQuat(pose[:4], turn, pose[:4].copy())
        pose[4:] = data.site_xpos[self._site] + twist[:3] * self.timestep_s
        return mink.SE3(pose)

    def _solved(self, positions_rad: NDArray) -> NDArray[np.float64] | None:
        """(j,) the joints' step (rad) that serves the objectives best within the limits.

        None where there is none. mink states what the tool and further limits want. The posture it
        would put the same way, and the joints' ranges and speeds as twice as many rows, which the
        solver takes as bounds.
        """
        hessian, gradient = self._tool.compute_qp_objective(self.configuration)
        hessian = hessian + self._own_hessian
        gradient = gradient - _POSTURE_COST**2 * (self._home_rad - positions_rad)
        lower = np.maximum(_RANGE_GAIN * (self.lower_rad - positions_rad), -self._steps_rad)
        upper = np.minimum(_RANGE_GAIN * (self.upper_rad - positions_rad), self._steps_rad)
        rows = self._no_rows
        for limit in self.further_limits:
            further = limit.compute_qp_inequalities(self.configuration, self.timestep_s)
            if further.G is not None and further.h is not None:
                rows = np.concatenate([rows, further.G])
                upper = np.concatenate([upper, further.h])
                lower = np.concatenate([lower, np.full(len(further.h), -np.inf)])
        inequalities = np.zeros(len(upper), c_int)
        step, _, found, _ = daqp.solve(hessian, gradient, rows, upper, lower, inequalities)
        return step if found > 0 else None

    def _inside(self, positions_rad: NDArray) -> NDArray[np.float64]:
        return np.minimum(np.maximum(positions_rad, self.lower_rad), self.upper_rad)


def twist_between(before: NDArray, after: NDArray, timestep_s: float) -> NDArray[np.float64]:
    """(6,) m/s and rad/s, world frame: what moves a tool from one (4, 4) pose to another."""
    quaternion, turn = np.zeros(4), np.zeros(3)
    mujoco.mju_mat2Quat(quaternion, (after[:3, :3] @ before[:3, :3].T).ravel())
    mujoco.mju_quat2Vel(turn, quaternion, timestep_s)
    return np.concatenate([(after[:3, 3] - before[:3, 3]) / timestep_s, turn])
