"""A gripper from an arm's file: the tool's site, the servo that closes it, the wrist's camera."""

from typing import Any

import numpy as np

from sheath_manip.tasks.robots.arm_file import Gripper
from sheath_manip.tasks.robots.elements import found
from sheath_manip.tasks.robots.gripper import Measured

TOOL, CLOSING, CAMERA = "tool_of_file", "closing_of_file", "wrist"
"""names; models have sites and tendons called `tool` and `closing` themselves"""
_CLOSING_M_S = 0.3
"""that the gripper's target may move at, more than it is asked for"""
_BEYOND_M = 0.01
"""that the target may go beyond open and closed"""
_SITES = 4


def coupling_of(gripper: Gripper) -> Measured:
    """Return how far the gripper is closed at each coordinate; raises ParameterError."""
    return Measured(gripper.closed_m)


def opening_m(gripper: Gripper) -> float:
    """Return how far it closes."""
    return max(closed for _, closed in gripper.closed_m)


def open_positions(gripper: Gripper, root: Any) -> dict[str, float]:
    """Return where the fingers' joints stand when it is open, by their names in `root`."""
    share = coupling_of(gripper).coordinate(0.0) / len(gripper.joints)
    names = {each.name: each.full_identifier for each in root.find_all("joint")}
    return {names[name]: sign * share for name, sign in gripper.joints.items()}


def add_gripper(gripper: Gripper, root: Any) -> None:
    """Make the gripper in `root` a tool; raises ParameterError for a part that it lacks."""
    _add_site_and_camera(gripper, root)
    joints = [found(root, "joint", name) for name in gripper.joints]
    signs = tuple(gripper.joints.values())
    for joint in joints:
        if gripper.armature is not None:
            joint.armature = gripper.armature
        if gripper.damping is not None:
            joint.damping = gripper.damping
    for name in gripper.pads:
        pad = found(root, "geom", name)
        # Four directions of friction: with three an object slowly slips out of the pads.
        pad.condim, pad.priority = 4, 1
        pad.friction, pad.solref = [gripper.pad_friction, 0.01, 0.0002], [0.006, 1]
    if gripper.abreast and len(joints) == 2:
        ratio = [0, signs[0] * signs[1], 0, 0, 0]
        root.equality.add(
            "joint", joint1=joints[0], joint2=joints[1], polycoef=ratio, solref=[0.005, 1]
        )
    tendon = root.tendon.add("fixed", name=CLOSING)
    for joint, sign in zip(joints, signs, strict=True):
        tendon.add("joint", joint=joint, coef=sign)
    coupling, opening = coupling_of(gripper), opening_m(gripper)
    ends = sorted(coupling.coordinate(each) for each in (-_BEYOND_M, opening + _BEYOND_M))
    speed = _CLOSING_M_S * (ends[1] - ends[0]) / opening
    root.actuator.add(
        "intvelocity",
        name=CLOSING,
        tendon=tendon,
        kp=gripper.kp,
        kv=gripper.kp * gripper.lag_s,
        forcerange=[-gripper.force, gripper.force],
        ctrlrange=[-speed, speed],
        actrange=ends,
    )


def _add_site_and_camera(gripper: Gripper, root: Any) -> None:
    body = found(root, "body", gripper.body)
    approach, across = np.array(gripper.approach), np.array(gripper.across)
    frame = np.column_stack([approach, across, np.cross(approach, across)])
    pinch = np.array(gripper.pinch_m)
    axes = [*approach, *across]
    body.add("site", name=TOOL, pos=pinch, xyaxes=axes, size=[0.005], group=_SITES)
    # Looks along the fingers at what they close on.
    right, up = frame @ [0.0, -1.0, 0.0], frame @ [0.3, 0.0, 1.0]
    place = pinch + frame @ gripper.camera_m
    body.add("camera", name=CAMERA, pos=place, xyaxes=[*right, *up], fovy=75)
