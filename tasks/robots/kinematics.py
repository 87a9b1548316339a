"""An arm alone, its tool rigid: what inverse kinematics and the command filter look at."""

from typing import Any

import mujoco
import numpy as np
from dm_control import mjcf
from numpy.typing import NDArray

from sheath_manip.controllers.twist_control import TwistControl
from sheath_manip.tasks.robots.elements import inherited
from sheath_manip.tasks.robots.robot import RobotDescription


def kinematic_root(description: RobotDescription) -> mjcf.RootElement:
    """The arm alone, its tool rigid (a gripper open): for inverse kinematics."""
    root: Any = description.build()
    for kind in ("actuator", "tendon", "equality", "contact"):
        for element in root.find_all(kind):
            element.remove()
    if description.drawn_geoms:
        _strip_drawn(root, description)
    for joint in root.find_all("joint"):
        if joint.full_identifier not in description.joint_speeds_rad_s:
            _hold_open(joint, description)
            joint.remove()
    return root


def twist_control(
    description: RobotDescription, timestep_s: float, root: mjcf.RootElement | None = None
) -> TwistControl:
    """The arm's control by twists of its tool; `root` is a `kinematic_root` with more in it."""
    root = kinematic_root(description) if root is None else root
    return TwistControl(
        mjcf.Physics.from_mjcf_model(root).model.ptr,
        description.tool_site,
        description.joint_speeds_rad_s,
        description.home_rad,
        timestep_s,
    )


def last_joint_along(control: TwistControl, description: RobotDescription) -> float:
    """Return the cosine between the last joint's axis and the tool's approach, at home."""
    approach = control.transform_tool_to_world(np.array(description.home_rad))[:3, 0]
    return float(control.configuration.data.xaxis[-1] @ approach)


def open_at(description: RobotDescription) -> dict[str, float]:
    """Return where the joints of an open gripper stand, m or rad, by name."""
    share = description.coupling.coordinate(0.0) / max(len(description.closing_joints), 1)
    signed = zip(description.closing_joints, description.closing_signs, strict=False)
    return {name: sign * share for name, sign in signed}


def _strip_drawn(root: Any, description: RobotDescription) -> None:
    """Take out what is only drawn, and the meshes that only that wants: they cost the compiler."""
    drawn = set(description.drawn_geoms)
    for geom in root.find_all("geom"):
        if geom.full_identifier in drawn:
            geom.remove()
    wanted = {id(geom.mesh) for geom in root.find_all("geom") if geom.mesh is not None}
    for mesh in root.find_all("mesh"):
        if id(mesh) not in wanted:
            mesh.remove()
    # A body may have had its mass from what was drawn.
    root.compiler.boundmass = root.compiler.boundinertia = 1e-4


def _hold_open(joint: Any, description: RobotDescription) -> None:
    """Move a finger to where it is open, where that is not where its file draws it."""
    value = open_at(description).get(joint.full_identifier, 0.0)
    if value == 0.0:
        return
    body = joint.parent
    axis = np.array(inherited(joint, "axis", (0.0, 0.0, 1.0)), float)
    axis /= np.linalg.norm(axis)
    rotation = np.array(inherited(body, "quat", (1.0, 0.0, 0.0, 0.0)), float)
    rotation /= np.linalg.norm(rotation)
    moved, turn = value * axis, np.array([1.0, 0.0, 0.0, 0.0])
    if inherited(joint, "type", "hinge") == "hinge":
        anchor = np.array(inherited(joint, "pos", (0.0, 0.0, 0.0)), float)
        mujoco.mju_axisAngle2Quat(turn, axis, value)
        moved = anchor - _rotated(anchor, turn)
    body.pos = np.array(inherited(body, "pos", (0.0, 0.0, 0.0)), float) + _rotated(moved, rotation)
    turned = np.empty(4)
    mujoco.mju_mulQuat(turned, rotation, turn)
    body.quat = turned


def _rotated(vector: NDArray, wxyz: NDArray) -> NDArray[np.float64]:
    result = np.empty(3)
    mujoco.mju_rotVecQuat(result, vector, wxyz)
    return result
