"""A stand-in for an expert that is missing: go back into the support by the way one came.

Lee, Laskey, Fox and Goldberg (2018), Constraint Estimation and Derivative-Free Recovery for Robot
Learning from Demonstrations, steer a robot that nears the edge of the support back into it by
trying small controls. Here it retraces the way that it has just come: that led out of the support,
so it leads back into it, and nothing was in the way.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.trail import Trail
from sheath_manip.controllers.twist_control import twist_between
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Action, Observation


class BackUp:
    """Retraces the tool's path for as long as it is asked to act, then stands still.

    When it is enough is for the gate to say. Its actions are no labels to learn from.
    """

    def __init__(
        self,
        tool_pose: Callable[[], NDArray[np.float64]],
        rest: Callable[[], Action],
        twist_scale: NDArray,
        timestep_s: float,
        speed_share: float = 0.6,
        trail: Trail | None = None,
    ) -> None:
        """Drive a tool whose action begins with a twist.

        `tool_pose` gives the (4, 4) pose of the tool now, world frame; `rest` the (a,) action that
        leaves everything as it is, whose first six entries are a twist in shares of `twist_scale`
        (6,) (m/s, rad/s, world frame); `speed_share` of that is not exceeded.
        """
        if not 0 < speed_share <= 1:
            raise ParameterError(f"a speed share of {speed_share}; wanted more than 0, at most 1")
        self._tool_pose = tool_pose
        self._rest = rest
        self._twist_scale = np.array(twist_scale, float)
        self._timestep_s = timestep_s
        self._speed_share = speed_share
        self.trail = trail or Trail()

    def reset(self) -> None:
        """Forget the way of the last episode."""
        self.trail.clear()

    def follow(self, observation: Observation) -> None:  # noqa: ARG002
        """Note where the tool is, no matter who moved it there."""
        self.trail.pass_through(self._tool_pose())

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """Return the (a,) action towards the last waypoint."""
        action = self._rest()
        here = self._tool_pose()
        goal = self.trail.before(here)
        if goal is not None:
            twist = twist_between(here, goal, self._timestep_s) / self._twist_scale
            fastest = float(np.abs(twist).max())
            action[:6] = twist * min(1.0, self._speed_share / max(fastest, 1e-12))
        return action
