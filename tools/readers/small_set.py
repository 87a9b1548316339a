"""A small data set that LeRobot and Minari write and this project reads: the same on both sides.

Imported by scripts in venvs of other projects, so that nothing of this project is imported here.
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
    small = rng.integers(0, 256, (length, SMALL_PX, SMALL_PX, 3))
    return {
        "state": rng.normal(size=(length, len(STATE))).astype(np.float32),
        "action": rng.normal(size=(length, len(ACTION))).astype(np.float32),
        "reward": rng.normal(size=length).astype(np.float32),
        "intervention": rng.random(length) < 0.5,
        "success": np.arange(length) == (length - 1 if number != 1 else -1),
        "film": np.stack([_frame(number, t) for t in range(length)]),
        "small": small.astype(np.uint8),
    }


def after(number: int) -> dict[str, np.ndarray]:
    """Return what is seen after an episode's last action, where a format has a place for it."""
    return {
        "state": np.full(len(STATE), 9 + number, np.float32),
        "film": _frame(number, LENGTHS[number]),
    }


def _frame(number: int, t: int) -> np.ndarray:
    """(h, w, 3)"""
    row, column = np.mgrid[:SIZE_PX, :SIZE_PX]
    channels = (2 * row + 20 * t, 2 * column + 30 * number, 128 + 0 * row + 8 * t)
    return np.clip(np.stack(channels, -1), 0, 255).astype(np.uint8)
