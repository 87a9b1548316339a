"""From a twist of the tool to joint targets, by differential inverse kinematics (mink)."""

from collections.abc import Mapping, Sequence

import mink
import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError

_POSTURE_COST = 1e-3
"""settles what the twist leaves open, next to a singularity, without pulling at the tool"""
_DAMPING = 1e-6


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
        self._tool_site = tool_site
        self._tool = mink.FrameTask(tool_site, "site", position_cost=1.0, orientation_cost=0.3)
        self._posture = mink.PostureTask(model, cost=_POSTURE_COST)
        self._posture.set_target(np.array(home_rad, float))
        self._own_limits = (
            mink.ConfigurationLimit(model),
            mink.VelocityLimit(model, joint_speeds_rad_s),
        )
        self.further_limits: tuple[mink.Limit, ...] = ()
        """beside the joints' ranges and speeds"""
        limited = model.jnt_limited.astype(bool)
        self.lower_rad = np.where(limited, model.jnt_range[:, 0], -np.inf)
        self.upper_rad = np.where(limited, model.jnt_range[:, 1], np.inf)

    def transform_tool_to_world(self, positions_rad: NDArray) -> NDArray[np.float64]:
        """(4, 4) pose of the tool (m) with the joints at (j,) `positions_rad`."""
        return self._pose(positions_rad).as_matrix()

    def joint_targets(self, targets_rad: NDArray, twist: NDArray) -> NDArray[np.float64]:
        """(j,) the joints' targets (rad) at the end of a control step that starts with theirs.

        `twist` is (6,): velocity of the tool (m/s) and angular velocity (rad/s), both in the world
        frame. Where no motion is admissible the targets stay.
        """
        twist = np.asarray(twist, np.float64)
        if twist.shape != (6,) or not np.isfinite(twist).all():
            raise ParameterError(f"twist {twist.tolist()}; wanted 6 finite numbers, m/s and rad/s")
        pose = self._pose(targets_rad)
        # From here on the configuration holds these joints, which solve_ik starts from.
        moved = twist * self.timestep_s
        self._tool.set_target(
            mink.SE3.from_rotation_and_translation(
                mink.SO3.exp(moved[3:]) @ pose.rotation(), pose.translation() + moved[:3]
            )
        )
        try:
            rates = mink.solve_ik(
                self.configuration,
                [self._tool, self._posture],
                self.timestep_s,
                solver="daqp",
                damping=_DAMPING,
                limits=[*self._own_limits, *self.further_limits],
            )
        except mink.NoSolutionFound:
            return self.configuration.q
        return self.configuration.integrate(rates, self.timestep_s)

    def _pose(self, positions_rad: NDArray) -> mink.SE3:
        inside = np.minimum(np.maximum(positions_rad, self.lower_rad), self.upper_rad)
        self.configuration.update(inside)
        return self.configuration.get_transform_frame_to_world(self._tool_site, "site")
