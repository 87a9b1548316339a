"""Kinova's Jaco as dm_control has it, with the project's own jaw on its wrist."""

from pathlib import Path
from typing import Any

import numpy as np
from dm_control import mjcf
from dm_control.entities.manipulators import kinova

from sheath_manip.tasks.robots.own_arm import JAW, JAW_FINGERS
from sheath_manip.tasks.robots.robot import ASSETS, RobotDescription

# dm_control's jaco_arm.py: 36 and 48 degrees a second.
_LARGE_RAD_S, _SMALL_RAD_S = float(np.deg2rad(36)), float(np.deg2rad(48))
_JOINT_SPEEDS_RAD_S = {f"joint_{n}": _LARGE_RAD_S if n < 4 else _SMALL_RAD_S for n in range(1, 7)}
_TURNS_RAD = 4 * np.pi
"""of joints without a range, whose servos want one"""


def jaco_with(tool: Path) -> mjcf.RootElement:
    """The arm with the tool of that MJCF file; servos are those of the project's own in kind."""
    arm: Any = kinova.JacoArm().mjcf_model
    for element in (*arm.find_all("actuator"), *arm.find_all("sensor")):
        element.remove()
    # Off, as in its file, the distances of collision avoidance cost ten times as much.
    arm.option.flag.nativeccd = "enable"
    for body in arm.find_all("body"):
        body.gravcomp = 1.0
    for name in _JOINT_SPEEDS_RAD_S:
        joint = arm.find("joint", name)
        limits = joint.range if joint.limited == "true" else (-_TURNS_RAD, _TURNS_RAD)
        # Its armature of 4 (2 in the wrist) wants this much to follow within .05 s.
        large = name < "joint_4"
        arm.actuator.add(
            "intvelocity",
            name=name,
            joint=joint,
            kp=6000 if large else 3000,
            kv=300 if large else 150,
            ctrlrange=[-4, 4],
            actrange=list(limits),
        )
    wrist = arm.find("site", "wristsite").parent
    # Its site points forward along z, the tools' mounts along x.
    turned = wrist.add("site", name="tool_mount", xyaxes=[0, 0, -1, 1, 0, 0], group=4)
    turned.attach(mjcf.from_path(str(tool)))
    return arm


def build_jaco_with_jaw() -> mjcf.RootElement:
    """The arm with the parallel jaw."""
    return jaco_with(ASSETS / "jaw.xml")


def build_jaco_with_blade() -> mjcf.RootElement:
    """The arm with the needle knife."""
    return jaco_with(ASSETS / "blade.xml")


JACO_WITH_JAW = RobotDescription(
    build=build_jaco_with_jaw,
    joint_speeds_rad_s=_JOINT_SPEEDS_RAD_S,
    # The pinch at (.40, 0, .36) m, straight down, the elbow up.
    home_rad=(2.995, 3.481, 1.514, -0.394, 1.388, 1.03),
    servos=tuple(_JOINT_SPEEDS_RAD_S),
    body_geoms=(*(f"link_{n}" for n in range(2, 6)), "ring_6", "jaw/palm", *JAW_FINGERS),
    **JAW,
)

JACO_WITH_BLADE = RobotDescription(
    build=build_jaco_with_blade,
    joint_speeds_rad_s=_JOINT_SPEEDS_RAD_S,
    # The tip at (.42, 0, .20) m, straight down.
    home_rad=(2.9932, 3.7078, 1.3562, -0.2431, 0.9209, 1.1795),
    tool_site="blade/tip",
    servos=tuple(_JOINT_SPEEDS_RAD_S),
    body_geoms=(*(f"link_{n}" for n in range(2, 6)), "ring_6", "blade/handle", "blade/needle"),
)
