"""An arm with a tool: what a task has to know of it, whichever it is."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from dm_control import composer, mjcf
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.assets import assets_of
from sheath_manip.tasks.robots.gripper import SLIDING, Coupling

ASSETS = assets_of("arm")


@dataclass(frozen=True)
class Footprint:
    """A rectangle across the tool's approach, around it."""

    half_along_m: float
    """the way that the fingers move"""
    half_across_m: float
    above_tool_m: float
    """how far behind the tool's site it begins"""


@dataclass(frozen=True)
class RobotDescription:
    """An arm and its tool by the names of their parts. MJCF names, as of the assembled root."""

    build: Callable[[], mjcf.RootElement]
    """the arm with its tool attached"""
    joint_speeds_rad_s: Mapping[str, float]
    """the arm's joints in order, with their top speeds"""
    home_rad: tuple[float, ...]
    """where the arm waits, and the posture it prefers"""
    tool_site: str
    """x is the approach; y the way that fingers move, where there are any"""
    servos: tuple[str, ...]
    """actuators of the arm's joints, in order: ctrl is the rate, activation the target"""
    closing_servo: str | None = None
    """of a gripper: activation is how far it is to be closed (m)"""
    closing_joints: tuple[str, ...] = ()
    """whose sum tells how far it is closed"""
    closing_signs: tuple[float, ...] = (1.0, 1.0)
    """of the joints in that sum"""
    coupling: Coupling = SLIDING
    """from that sum to how far it is closed (m)"""
    opening_m: float = 0.0
    """of the gripper at its widest"""
    tip_m: float = 0.035
    """how far the finger tips stand out before the tool's site"""
    depth_m: float = 0.05
    """how much of an object has room in the gripper behind the tool's site"""
    footprints: tuple[Footprint, ...] = ()
    """what of the tool stands between objects when it points down"""
    body_geoms: tuple[str, ...] = ()
    """that may come near objects, the tool's among them"""
    drawn_geoms: tuple[str, ...] = ()
    """that touch nothing: for pictures alone"""
    mirrored_joints: tuple[str, ...] | None = None
    """those that turn the other way when the robot is reflected at its x-z plane; None where that
    makes another robot"""


class Robot(composer.Entity):
    """The robot in a scene."""

    _mjcf_root: Any  # mjcf makes its attributes from MuJoCo's schema at run time

    def _build(self, description: RobotDescription) -> None:
        self.description = description
        self._mjcf_root = description.build()
        self.joints = [self._found("joint", name) for name in description.joint_speeds_rad_s]
        self.servos = [self._found("actuator", name) for name in description.servos]
        self.tool_site = self._found("site", description.tool_site)
        self.closing_joints = [self._found("joint", name) for name in description.closing_joints]
        closing = description.closing_servo
        self.closing_servo = None if closing is None else self._found("actuator", closing)

    @property
    def mjcf_model(self) -> mjcf.RootElement:
        """The MJCF model."""
        return self._mjcf_root

    def joint_positions(self, physics: mjcf.Physics) -> NDArray[np.float64]:
        """Return the (j,) joint positions of the arm, rad."""
        return np.array(physics.bind(self.joints).qpos)

    def _found(self, kind: str, name: str) -> Any:
        element = self._mjcf_root.find(kind, name)
        if element is None:
            raise ParameterError(f"the robot has no {kind} {name!r}")
        return element
