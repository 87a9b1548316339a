"""Bends a twist around obstacles: differential IK under collision limits (mink)."""

from collections.abc import Sequence
from dataclasses import dataclass

import mink
import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.twist_control import TwistControl


@dataclass(frozen=True)
class Guard:
    """A distance to keep between two groups of geoms, by name."""

    robot: tuple[str, ...]
    obstacles: tuple[str, ...]
    minimum_m: float = 0.012
    detection_m: float = 0.05
    """from which on the approach is slowed down"""
    gain: float = 0.5
    """share of the distance left that one step may use up"""


class GuardedTwist:
    """The part of a twist that obstacles leave.

    They are the mocap bodies of the control's model.
    """

    def __init__(self, control: TwistControl, guards: Sequence[Guard]) -> None:
        self.control = control
        self._guards = guards
        self.rebuild()

    def rebuild(self) -> None:
        """Take note that obstacles have changed their shapes, which the limits remember."""
        model = self.control.model
        self.control.further_limits = tuple(
            mink.CollisionAvoidanceLimit(
                model,
                [(guard.robot, guard.obstacles)],
                gain=guard.gain,
                minimum_distance_from_collisions=guard.minimum_m,
                collision_detection_distance=guard.detection_m,
            )
            for guard in self._guards
        )

    def move_obstacles(self, positions_m: NDArray, wxyz: NDArray) -> None:
        """Put the model's mocap bodies at (b, 3) and (b, 4) in the world frame."""
        data = self.control.configuration.data
        data.mocap_pos[:] = positions_m
        data.mocap_quat[:] = wxyz

    def joint_targets(self, targets_rad: NDArray, twist: NDArray) -> NDArray[np.float64]:
        """(j,) the joints' targets (rad) one control step on, as of `TwistControl`."""
        return self.control.joint_targets(targets_rad, twist)

    def twist(self, targets_rad: NDArray, twist: NDArray) -> NDArray[np.float64]:
        """(6,) the tool's velocity (m/s, rad/s, world frame) that remains of `twist`."""
        control = self.control
        moved = control.joint_targets(targets_rad, twist)
        before = control.transform_tool_to_world(targets_rad)
        after = control.transform_tool_to_world(moved)
        turn = mink.SO3.from_matrix(after[:3, :3] @ before[:3, :3].T).log()
        return np.concatenate([after[:3, 3] - before[:3, 3], turn]) / control.timestep_s
