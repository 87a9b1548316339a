"""Who may stand in where no expert can take over a robot."""

from controllers.back_up import BackUp
from controllers.hold import Hold
from tasks.robots.drive import TWIST_SCALE, RobotDrive


def hold(drive: RobotDrive) -> Hold:
    """Stands still."""
    return Hold(drive.rest)


def back_up(drive: RobotDrive, timestep_s: float) -> BackUp:
    """Goes back by the way that its tool came."""
    return BackUp(drive.commanded_tool_pose, drive.rest, TWIST_SCALE, timestep_s)
