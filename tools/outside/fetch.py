"""FetchPickAndPlace-v4 of gymnasium-robotics as a task: an expert, and what success is."""

import numpy as np

from sheath_manip.adapters.from_gymnasium import from_gymnasium

ABOVE_M, NEAR_M, OBJECT_M = 0.08, 0.012, 0.05
"""how far above the object the hand comes, within what it is there, and how wide the object is"""


def pick_and_place(seen):
    """Return the action: over the object, down, close, and to the goal."""
    hand, cube, fingers = np.split(seen["observation"][:11], [3, 6])[:2] + [
        seen["observation"][9:11]
    ]
    goal, to_cube = seen["desired_goal"], cube - hand
    aside, held = np.linalg.norm(to_cube[:2]), np.linalg.norm(to_cube) < 2 * NEAR_M
    if held and fingers.sum() < OBJECT_M + 0.004:
        return np.append(np.clip(8 * (goal - cube), -1, 1), -1.0)
    if held:
        return np.array([0.0, 0.0, 0.0, -1.0])
    if aside > NEAR_M:
        to_cube[2] += ABOVE_M
    return np.append(np.clip(8 * to_cube, -1, 1), 1.0)


FETCH = from_gymnasium(
    "gymnasium_robotics:FetchPickAndPlace-v4",
    expert=pick_and_place,
    summary="pick up a cube and bring it to a goal, on the table or in the air",
    name="fetch-pick-and-place",
    leave_out=["achieved_goal"],
    success_steps=5,
    rest=[0, 0, 0, 0],
    tool="robot0:grip",
)
