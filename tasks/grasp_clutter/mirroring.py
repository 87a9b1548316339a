"""Left for right: what becomes of features and actions in a mirrored scene."""

from collections.abc import Collection

from sheath_manip.tasks.robots.robot import RobotDescription
from sheath_manip.types import Mirror

SYMMETRIC_CAMERAS = frozenset({"front", "wrist"})
"""which see the mirror image of what they would see of the mirrored scene"""


def mirror_of(robot: RobotDescription, cameras: Collection[str]) -> Mirror | None:
    """Left for right, where neither the arm nor a camera stands aside; None where one does."""
    mirrored = robot.mirrored_joints
    if mirrored is None or not SYMMETRIC_CAMERAS.issuperset(cameras):
        return None
    joints = [-1.0 if name in mirrored else 1.0 for name in robot.joint_speeds_rad_s]
    tool, gripper = (1.0, -1.0, 1.0), (1.0, 1.0)
    velocity, turn, grip = (1.0, -1.0, 1.0), (-1.0, 1.0, -1.0), (1.0,)
    return Mirror((*joints, *tool, *gripper), (*velocity, *turn, *grip))
