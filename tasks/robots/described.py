"""The description of an arm from its file, with its gripper or with the needle knife."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from dm_control import mjcf

from sheath_manip.tasks.robots.arm_file import ArmFile, path_of, read_arm
from sheath_manip.tasks.robots.assembly import ArmWithBlade, ArmWithGripper, drawn_only
from sheath_manip.tasks.robots.fingers import CLOSING, TOOL, coupling_of, opening_m
from sheath_manip.tasks.robots.kinematics import twist_control
from sheath_manip.tasks.robots.placing import joints_for
from sheath_manip.tasks.robots.robot import Footprint, RobotDescription

_MOVED_BY = 2
"""joints, from which on a link may get in the way of objects"""
_KNIFE_M = (0.42, 0.0, 0.20)
"""where the knife's tip waits"""
_STEPS = 60
"""of inverse kinematics, a second each, to get there"""


def arm_with_gripper(arm: str) -> RobotDescription:
    """Return the arm of that name or file with its gripper; raises ParameterError, SetupError."""
    path = path_of(arm)
    told = read_arm(path)
    gripper, build = told.gripper, ArmWithGripper(path)
    root = build()
    return RobotDescription(
        build=build,
        joint_speeds_rad_s={joint.name: joint.speed_rad_s for joint in told.joints},
        home_rad=tuple(joint.home_rad for joint in told.joints),
        tool_site=_named(root, "site", TOOL),
        servos=tuple(joint.name for joint in told.joints),
        closing_servo=_named(root, "actuator", CLOSING),
        closing_joints=tuple(_named(root, "joint", name) for name in gripper.joints),
        closing_signs=tuple(gripper.joints.values()),
        coupling=coupling_of(gripper),
        opening_m=opening_m(gripper),
        tip_m=gripper.tip_m,
        depth_m=gripper.depth_m,
        footprints=tuple(
            Footprint(each.half_along_m, each.half_across_m, each.above_tool_m)
            for each in gripper.footprints
        ),
        body_geoms=tuple(_guarded(root, told)),
        drawn_geoms=tuple(_drawn(root)),
    )


def arm_with_blade(arm: str) -> RobotDescription:
    """Return the arm of that name or file with the knife; raises ParameterError, SetupError."""
    path = path_of(arm)
    told, build = read_arm(path), ArmWithBlade(path)
    root = build()
    blade = RobotDescription(
        build=build,
        joint_speeds_rad_s={joint.name: joint.speed_rad_s for joint in told.joints},
        home_rad=tuple(joint.home_rad for joint in told.joints),
        tool_site=_named(root, "site", "tip"),
        servos=tuple(joint.name for joint in told.joints),
        body_geoms=tuple(_guarded(root, told)),
        drawn_geoms=tuple(_drawn(root)),
    )
    return replace(blade, home_rad=knife_home_rad(blade))


def knife_home_rad(description: RobotDescription) -> tuple[float, ...]:
    """Return where an arm waits with the knife, from where it waits with its gripper."""
    # So long a step that no joint is too slow for it.
    control = twist_control(description, 1.0)
    start = np.array(description.home_rad)
    down, across = np.array([0.0, 0.0, -1.0]), control.transform_tool_to_world(start)[:3, 1]
    across = across * [1.0, 1.0, 0.0] / np.hypot(*across[:2])
    rotation = np.column_stack([down, across, np.cross(down, across)])
    joints = joints_for(control, start, np.array(_KNIFE_M), rotation, _STEPS)
    return tuple(float(each) for each in joints)


def _named(root: Any, kind: str, name: str) -> str:
    """The identifier, in the whole arm, of the last element that its own part calls so."""
    return [each for each in root.find_all(kind) if each.name == name][-1].full_identifier


def _drawn(root: Any) -> Iterator[str]:
    for geom in root.find_all("geom"):
        if drawn_only(geom):
            yield geom.full_identifier


def _guarded(root: Any, told: ArmFile) -> Iterator[str]:
    """What is to be kept off objects."""
    arm_joints = {joint.name for joint in told.joints}
    for geom in root.find_all("geom"):
        bodies = list(_bodies_above(geom))
        moved = sum(
            joint.full_identifier in arm_joints for body in bodies for joint in _joints(body)
        )
        holder = getattr(bodies[0], "name", None) if bodies else None
        wanted = holder in told.guarded if told.guarded else moved >= _MOVED_BY
        if wanted and not drawn_only(geom):
            yield geom.full_identifier


def _bodies_above(element: Any) -> Iterator[Any]:
    """The body that holds it, and all between that and the world, through what is attached."""
    body = element.parent
    while body is not None:
        if body.tag == "worldbody":
            part = body.root
            body = mjcf.get_attachment_frame(part) if part.parent_model is not None else None
        else:
            yield body
            body = body.parent


def _joints(body: Any) -> list[Any]:
    return list(getattr(body, "joint", ()))
