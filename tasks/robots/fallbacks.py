"""Controllers and devices that may drive a robot in the place of its scripted expert."""

from sheath_manip.controllers.back_up import BackUp
from sheath_manip.controllers.hold import Hold
from sheath_manip.controllers.teleop.arm import ArmHands
from sheath_manip.tasks.robots.drive import TWIST_SCALE, RobotDrive


def hold(drive: RobotDrive) -> Hold:
    """Return a controller that stands still."""
    return Hold(drive.rest)


def back_up(drive: RobotDrive, timestep_s: float) -> BackUp:
    """Return a controller that goes back by the way that its tool came."""
    return BackUp(drive.commanded_tool_pose, drive.rest, TWIST_SCALE, timestep_s)


def teleop(drive: RobotDrive) -> ArmHands:
    """Return how a person moves the tool."""
    return ArmHands(drive.commanded_tool_pose, drive.rest, TWIST_SCALE)
