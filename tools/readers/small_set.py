"""A small data set that LeRobot and Minari write and this project reads: the same on both sides.

Imported by scripts in venves of other projects, so that nothing of this project is imported here.
"""

import numpy as np

FPS = 10
LENGTHS = (4, 6, 5)
TASKS = ("lift the cube", "lift the cube", "stack the cube")
STATE = ("shoulder_rad", "elbow_rad", "gripper_m")
ACTION = ("shoulder_rad", "elbow_rad")
SIZE_PX = 64
"""of the film; the smallest side that every encoder takes"""
SMALL_PX = 8
"""of the images"""


def episode(number: int) -> dict[str, np.ndarray]:
    """Return the columns of an episode, (T, ...) each; images change slowly, as films do."""
    rng, length = np.random.default_rng(number), LENGTHS[number]
    t, row, column = np.ogrid[:length, :SIZE_PX, :SIZE_PX]
    film = np.stack(
        np.broadcast_arrays(2 * row + 20 * t, 2 * column + 30 * number, 128 + 0 * row + 8 * t), -1
    )
    small = rng.integers(0, 256, (length, SMALL_PX, SMALL_PX, 3))
    return {
        "state": rng.normal(size=(length, len(STATE))).astype(np.float32),
        "action": rng.normal(size=(length, len(ACTION))).astype(np.float32),
        "reward": rng.normal(size=length).astype(np.float32),
        "intervention": rng.random(length) < 0.5,
        "success": np.arange(length) == (length - 1 if number != 1 else -1),
        "film": np.clip(film, 0, 255).astype(np.uint8),
        "small": small.astype(np.uint8),
    }
