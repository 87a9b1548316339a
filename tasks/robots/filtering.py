"""The command filter of a robot on a table."""

from typing import Any

import numpy as np
from dm_control import mjcf
from numpy.typing import NDArray

from sheath_manip.controllers.command_filter import CommandFilter
from sheath_manip.controllers.joint_limits import JointLimits
from sheath_manip.controllers.speed_cap import Distance, SpeedCap, above
from sheath_manip.controllers.workspace import Workspace
from sheath_manip.tasks.robots.kinematics import kinematic_root
from sheath_manip.tasks.robots.robot import RobotDescription

TABLE_HEIGHT_M = 0.0
TOOL_LOWER_M = np.array([0.05, -0.6, 0.01])
TOOL_UPPER_M = np.array([0.85, 0.6, 0.8])
"""the box in which a tool may be, over the whole table"""


def command_filter(
    description: RobotDescription,
    timestep_s: float,
    clutter: Distance | None = None,
    box_m: tuple[NDArray, NDArray] = (TOOL_LOWER_M, TOOL_UPPER_M),
) -> CommandFilter:
    """Holds a robot clear of itself and of the table, and slow near it; its tool in `box_m`.

    Where the task knows how far a point is from the clutter, the tool is slow there instead. The
    box is its lower and its upper corner, both (3,) in the world frame; home lies in it.
    """
    root: Any = kinematic_root(description)
    root.worldbody.add(
        "geom", name="table", type="plane", size=[1, 1, 0.1], pos=[0, 0, TABLE_HEIGHT_M]
    )
    model = mjcf.Physics.from_mjcf_model(root).model.ptr
    home = np.array(description.home_rad)
    workspace = Workspace(model, description.tool_site, home, *box_m)
    if clutter is None:
        cap = SpeedCap(above(TABLE_HEIGHT_M), "speed near the table")
    else:
        cap = SpeedCap(clutter)
    joints = JointLimits.of(model, tuple(description.joint_speeds_rad_s.values()))
    return CommandFilter(joints, timestep_s, workspace, cap)
