"""The law under the collision limits of one robot: from the state of a scene to an action."""

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.controllers.closing_control import ClosingControl
from sheath_manip.controllers.guarded_twist import Guard, GuardedTwist
from sheath_manip.tasks.grasp_clutter.grasp_state import GraspCommand, GraspState
from sheath_manip.tasks.grasp_clutter.grasping import GraspLaw
from sheath_manip.tasks.grasp_clutter.outlines import Outlines
from sheath_manip.tasks.grasp_clutter.pool import SLOTS, Pool, add_pool, geom_names
from sheath_manip.tasks.grasp_clutter.room import JawRoom
from sheath_manip.tasks.grasp_clutter.scene import Scene
from sheath_manip.tasks.robots.drive import TWIST_SCALE
from sheath_manip.tasks.robots.kinematics import (
    kinematic_root,
    last_joint_along,
    twist_control,
)
from sheath_manip.tasks.robots.robot import RobotDescription
from sheath_manip.types import Action

_AWAY_M = np.array([0.0, 0.0, -5.0])
"""where an obstacle is put that is none now"""
WIDE_M, CLOSE_M = 0.012, 0.004
"""distances to keep from the clutter. A scene is solvable with the wide one, whatever way a policy
finds. The expert, which knows where everything is, comes closer: with the wide one it turned the
jaw first in five scenes of six, without need, and by an angle that no policy learned to see in 100
scenes; so in three of six, and it toppled nothing more"""
_TURNING_M = 0.002
"""more than that distance is wanted where the jaw is to go down"""
_HELD = 0.5
"""from how far around the target the pads may touch it"""


@dataclass(frozen=True, eq=False)
class Situation:
    """Robot and objects, as physics or a kinematic roll-out have them."""

    joint_targets_rad: NDArray[np.float64]
    """(j,) of the arm's servos"""
    closed_m: float
    pressed_m: float
    """how far the gripper's servo wants to close farther"""
    positions_m: NDArray[np.float64]
    """(n, 3) of the scene's objects, the target's first: of their feet"""
    wxyz: NDArray[np.float64]
    """(n, 4)"""
    rotations: NDArray[np.float64]
    """(n, 3, 3)"""


class GraspGuide:
    """Owns a model of the arm among obstacles; remembers nothing of an episode but its scene."""

    def __init__(
        self, description: RobotDescription, timestep_s: float, distance_m: float = CLOSE_M
    ) -> None:
        root = kinematic_root(description)
        add_pool(root, movable=False)
        control = twist_control(description, timestep_s, root)
        self._pool = Pool(control.model)
        clutter = [name for slot in SLOTS[1:] for name in geom_names(*slot)]
        self.guarded = GuardedTwist(
            control,
            [
                Guard(description.body_geoms, tuple(clutter), distance_m),
                # Closer than to the others, or the jaw could not go around it.
                Guard(description.body_geoms, tuple(geom_names(*SLOTS[0])), 0.003, 0.03),
            ],
        )
        self.opening_m = description.opening_m
        self._last_turns_down = last_joint_along(control, description) > 0
        room = JawRoom(description.footprints, distance_m + _TURNING_M)
        closing = ClosingControl(description.opening_m)
        self._law = GraspLaw(room, closing, description.tip_m, description.depth_m)
        self._mocap = [int(control.model.body_mocapid[body]) for body in self._pool.bodies]
        self._scene: Scene | None = None

    def begin(self, scene: Scene) -> None:
        """Take over the shapes of `scene`."""
        self._scene = scene
        self._pool.shape(scene)
        self._outlines = Outlines(scene.clutter)
        self.guarded.rebuild()

    def wish(self, situation: Situation) -> GraspCommand:
        """Return what the law wants, whatever is in the way."""
        assert self._scene is not None, "the guide has been given no scene yet"
        target = self._scene.target
        control = self.guarded.control
        tool = control.transform_tool_to_world(situation.joint_targets_rad)
        points, heights = self._outlines.at(situation.positions_m[1:], situation.rotations[1:])
        last = float(situation.joint_targets_rad[-1])
        turns = last - float(control.upper_rad[-1]), last - float(control.lower_rad[-1])
        state = GraspState(
            tool_position_m=tool[:3, 3],
            tool_rotation=tool[:3, :3],
            # The last joint turns about the approach, which points down, or against it.
            turn_range_rad=turns if self._last_turns_down else (-turns[1], -turns[0]),
            closed_m=situation.closed_m,
            pressed_m=situation.pressed_m,
            target_base_m=situation.positions_m[0],
            target_axis=situation.rotations[0, :, 2],
            target_radius_m=target.half_x_m,
            target_height_m=target.height_m,
            outlines_m=points,
            outline_heights_m=heights,
            raised_m=float(situation.positions_m[1:, 2].max()),
            leaning_rad=float(np.arccos(min(situation.rotations[1:, 2, 2].min(), 1.0))),
        )
        return self._law.command(state)

    def guard(self, situation: Situation, command: GraspCommand) -> None:
        """Put the obstacles where they are now; the target is none once it is between the pads."""
        model = self.guarded.control.model
        positions, wxyz = np.tile(_AWAY_M, (model.nmocap, 1)), np.zeros((model.nmocap, 4))
        wxyz[:, 0] = 1.0
        rows = [self._mocap[slot] for slot in self._pool.slots]
        positions[rows], wxyz[rows] = situation.positions_m, situation.wxyz
        if command.around > _HELD:
            positions[rows[0]] = _AWAY_M
        self.guarded.move_obstacles(positions, wxyz)

    def action(self, situation: Situation) -> tuple[Action, GraspCommand]:
        """(7,) the expert's action, and what it stands for."""
        command = self.wish(situation)
        self.guard(situation, command)
        twist = self.guarded.twist(situation.joint_targets_rad, command.twist)
        action = np.append(twist / TWIST_SCALE, command.grip)
        return np.clip(action, -1.0, 1.0).astype(np.float32), command


def rotations_of(wxyz: NDArray) -> NDArray[np.float64]:
    """Return the (n, 3, 3) rotations of (n, 4) unit quaternions."""
    matrices = np.empty((len(wxyz), 9))
    for row, quaternion in zip(matrices, wxyz, strict=True):
        mujoco.mju_quat2Mat(row, quaternion)
    return matrices.reshape(-1, 3, 3)
