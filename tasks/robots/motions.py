"""Which motions of its tool an arm lacks, by its Jacobian where it waits."""

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.robots.kinematics import twist_control
from sheath_manip.tasks.robots.robot import RobotDescription

MOTIONS = tuple(f"{kind} {axis}" for kind in ("move along", "turn about") for axis in "xyz")
"""of the tool in the world frame"""
_LEVER_M = 0.2
"""at which a turn of the tool counts as much as a move"""
_RANK = 1e-3
"""of the largest singular value"""


def lacking(description: RobotDescription) -> tuple[str, ...]:
    """Return the motions that the tool cannot make at home, of `MOTIONS`; none for six joints.

    As many as the Jacobian's rank falls short of six: those of which the joints come least near.
    """
    jacobian = jacobian_at_home(description)
    jacobian[3:] *= _LEVER_M
    left, values, _ = np.linalg.svd(jacobian)
    rank = int((values > _RANK * values[0]).sum())
    # Of a unit motion, what lies in the span of those that can be made.
    shares = (left[:, :rank] ** 2).sum(axis=1)
    least = sorted(np.argsort(shares, kind="stable")[: len(MOTIONS) - rank])
    return tuple(MOTIONS[each] for each in least)


def jacobian_at_home(description: RobotDescription) -> NDArray[np.float64]:
    """(6, j) m/s and rad/s of the tool a rad/s of each joint, world frame, where the arm waits."""
    control = twist_control(description, 1.0)
    control.transform_tool_to_world(np.array(description.home_rad))
    model, data = control.model, control.configuration.data
    mujoco.mj_comPos(model, data)
    jacobian = np.zeros((6, model.nv))
    site = model.site(description.tool_site).id
    mujoco.mj_jacSite(model, data, jacobian[:3], jacobian[3:], site)
    return jacobian


def said(description: RobotDescription) -> str | None:
    """One line about what the arm cannot do; None where there is nothing to say."""
    lacks, joints = lacking(description), len(description.home_rad)
    if not lacks:
        return None
    return f"the arm has {joints} joints: at home its tool cannot {' or '.join(lacks)} by itself"
