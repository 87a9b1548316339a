"""FetchPickAndPlace-v4 of gymnasium-robotics as a task: what is seen, and an expert."""

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict

from sheath_manip.adapters.from_gymnasium import from_gymnasium

SIZES = {"hand_m": 3, "to_cube_m": 3, "to_goal_m": 3, "open_m": 1}
SEEN = Dict({name: Box(-np.inf, np.inf, (size,)) for name, size in SIZES.items()})
NEAR_M, HELD_M = 0.02, 0.056
"""within what the hand is at the cube; how far apart the fingers are that hold it"""


def seen(observation):
    """Return what pick and place needs of what Fetch shows."""
    hand, cube = observation["observation"][:3], observation["observation"][3:6]
    return {
        "hand_m": hand,
        "to_cube_m": cube - hand,
        "to_goal_m": observation["desired_goal"] - cube,
        "open_m": observation["observation"][9:11].sum(keepdims=True),
    }


def make():
    """Return the environment with that to be seen."""
    fetch = gymnasium.make("gymnasium_robotics:FetchPickAndPlace-v4", disable_env_checker=True)
    return gymnasium.wrappers.TransformObservation(fetch, seen, SEEN)


def pick_and_place(seen):
    """Return the action: over the cube, down to it, close, and to the goal."""
    to_cube, aside_m = seen["to_cube_m"], np.linalg.norm(seen["to_cube_m"][:2])
    near_m = np.linalg.norm(to_cube)
    if near_m < NEAR_M + 0.01 and seen["open_m"] < HELD_M:
        return np.append(np.clip(8 * seen["to_goal_m"], -1, 1), -1)
    above = [0, 0, np.clip(3 * (aside_m - 0.015), 0, 0.08)]
    return np.append(np.clip(8 * (to_cube + above), -1, 1), 1 if near_m > NEAR_M else -1)


FETCH = from_gymnasium(
    make,
    name="fetch-pick-and-place",
    summary="pick up a cube and bring it to a goal, on the table or in the air",
    expert=pick_and_place,
    rest=[0, 0, 0, 0],
    tool="robot0:grip",
)
