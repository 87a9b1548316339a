"""The project's own arm (assets/arm), and its jaw."""

from pathlib import Path
from typing import Any

from dm_control import mjcf

from sheath_manip.tasks.robots.robot import ASSETS, Footprint, RobotDescription

_TOOL_MOUNT = "tool_mount"


def arm_with(tool: Path) -> mjcf.RootElement:
    """The arm with the tool of that MJCF file on its flange."""
    arm: Any = mjcf.from_path(str(ASSETS / "arm.xml"))
    arm.find("site", _TOOL_MOUNT).attach(mjcf.from_path(str(tool)))
    return arm


def build_arm_with_blade() -> mjcf.RootElement:
    """The arm with the needle knife."""
    return arm_with(ASSETS / "blade.xml")


def build_arm_with_jaw() -> mjcf.RootElement:
    """The arm with the parallel jaw."""
    return arm_with(ASSETS / "jaw.xml")


ARM_JOINT_SPEEDS_RAD_S = {
    "base_yaw": 1.5,
    "shoulder": 1.5,
    "elbow": 2.0,
    "wrist_pitch": 3.0,
    "wrist_yaw": 3.0,
    "wrist_roll": 3.0,
}
# The pinch at (.40, 0, .36) m, straight down.
HOME_RAD = (0.0, -1.509, 1.857, 1.048, 0.0, 0.0)

ARM_GEOMS = ("upper_arm", "forearm", "wrist_1", "wrist_2", "flange")
JAW_FINGERS = ("jaw/left_finger", "jaw/left_pad", "jaw/right_finger", "jaw/right_pad")

JAW: dict[str, Any] = {
    "tool_site": "jaw/pinch",
    "closing_servo": "jaw/closing",
    "closing_joints": ("jaw/left_finger", "jaw/right_finger"),
    "opening_m": 0.092,
    "footprints": (Footprint(0.057, 0.011, -0.035), Footprint(0.062, 0.018, 0.085)),
}
"""what a description says of the jaw, whichever arm carries it"""

ARM_WITH_JAW = RobotDescription(
    build=build_arm_with_jaw,
    joint_speeds_rad_s=ARM_JOINT_SPEEDS_RAD_S,
    home_rad=HOME_RAD,
    servos=tuple(ARM_JOINT_SPEEDS_RAD_S),
    body_geoms=(*ARM_GEOMS, "jaw/palm", *JAW_FINGERS),
    mirrored_joints=("base_yaw", "wrist_yaw", "wrist_roll"),
    **JAW,
)

# The tip at (.42, 0, .20) m, straight down.
BLADE_HOME_RAD = (0.0, -1.2155, 1.8599, 0.9264, 0.0, 0.0)

ARM_WITH_BLADE = RobotDescription(
    build=build_arm_with_blade,
    joint_speeds_rad_s=ARM_JOINT_SPEEDS_RAD_S,
    home_rad=BLADE_HOME_RAD,
    tool_site="blade/tip",
    servos=tuple(ARM_JOINT_SPEEDS_RAD_S),
    body_geoms=(*ARM_GEOMS, "blade/handle", "blade/needle"),
)
