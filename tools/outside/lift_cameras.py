"""Lift of robosuite through two cameras: where the cube is, only the pictures show."""

from sheath_manip.adapters.from_robosuite import from_robosuite
from tools.outside.lift import lift

SIDE_PX = 84

LIFT_CAMERAS = from_robosuite(
    "Lift",
    name="lift-cameras",
    settings={
        "robots": "Panda",
        "horizon": 60,
        # The simple shapes that collide are drawn in a quarter of the time of those for the eye.
        "render_collision_mesh": True,
        "render_visual_mesh": False,
    },
    cameras=dict.fromkeys(("agentview", "robot0_eye_in_hand"), (SIDE_PX, SIDE_PX)),
    summary="lift a cube off the table, seen through two cameras",
    expert=lift,
    leave_out=[
        *("cube_pos", "cube_quat", "gripper_to_cube_pos"),
        *("robot0_eef_quat", "robot0_eef_quat_site", "robot0_gripper_qvel"),
        *("robot0_joint_pos", "robot0_joint_pos_cos", "robot0_joint_pos_sin", "robot0_joint_vel"),
    ],
    rest=[0, 0, 0, 0, 0, 0, 0],
)
