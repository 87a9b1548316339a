"""Lift of robosuite as a task: an expert, and what is seen."""

import numpy as np

from sheath_manip.adapters.from_robosuite import from_robosuite

ABOVE_M, NEAR_M = 0.06, 0.012
"""how far above the cube the hand comes, and within what it is there"""
OPEN_M, STILL_M_PER_S = 0.068, 0.01
"""between the fingers while they are open; how fast they move once they have grasped"""


def lift(seen):
    """Return the action: over the cube, down, close, and up; the hand is not turned."""
    to_cube = seen["cube_pos"] - seen["robot0_eef_pos"]
    width_m, speed = np.ptp(seen["robot0_gripper_qpos"]), np.ptp(seen["robot0_gripper_qvel"])
    # What is grasped may slip a little before it is let go.
    near_m = NEAR_M if width_m > OPEN_M else 3 * NEAR_M
    if np.linalg.norm(to_cube) < near_m:
        up = 1.0 if width_m < OPEN_M and speed < STILL_M_PER_S else 0.0
        return np.array([0, 0, up, 0, 0, 0, 1.0])
    if np.linalg.norm(to_cube[:2]) > NEAR_M:
        to_cube[2] += ABOVE_M
    return np.concatenate([np.clip(15 * to_cube, -1, 1), [0, 0, 0, -1.0]])


LIFT = from_robosuite(
    "Lift",
    settings={"robots": "Panda", "horizon": 60},
    summary="lift a cube off the table",
    expert=lift,
    leave_out=[
        *("cube_quat", "robot0_eef_quat", "robot0_eef_quat_site", "robot0_gripper_qvel"),
        *("robot0_joint_pos", "robot0_joint_pos_cos", "robot0_joint_pos_sin", "robot0_joint_vel"),
    ],
    rest=[0, 0, 0, 0, 0, 0, 0],
)
