"""A toy task of continuous actions: move the hand to the red square, which two cameras see."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from sheath_manip.policies import make_policy
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.types import ActionSpec, TaskSpec
from sheath_manip.types.samples import Samples

SIDE_PX = 48
ACTION = ActionSpec(
    ("velocity_x_m_s", "velocity_y_m_s"),
    np.array([-0.2, -0.1], np.float32),
    np.array([0.2, 0.1], np.float32),
    tolerance=0.1,
)
SPEC = TaskSpec(
    name="reach",
    control_rate_hz=20.0,
    action=ACTION,
    cameras={"above": (SIDE_PX, SIDE_PX), "wrist": (SIDE_PX, SIDE_PX)},
    feature_names=("hand_x_m", "hand_y_m"),
    max_steps=100,
    metric="steps",
)
SETTINGS: dict[str, Any] = {
    "channels": (8, 8, 8, 8),
    "hidden": (64,),
    "steps": 250,
    "warm_steps": 20,
    "batch_size": 32,
    "learning_rate": 3e-3,
    # Here the place of the hand to the millimetre is what decides.
    "shift_px": 0,
    "feature_noise": 0.02,
}
"""with which the toy is learned in seconds"""
ACT_SETTINGS: dict[str, Any] = {
    **{name: value for name, value in SETTINGS.items() if name != "hidden"},
    "steps": 150,
    "learning_rate": 4e-3,
    "chunk": 4,
    "executed_steps": 3,
    "width": 32,
    "heads": 2,
    "layers": 1,
}


def reach_samples(count: int, seed: int, spread_m: float = 1.0) -> Samples:
    """Hand and square anywhere up to `spread_m` from the middle; 50 states an episode.

    From above the square is where it is; the wrist sees it relative to the hand, and blurs nothing.
    """
    rng = np.random.default_rng(seed)
    hand_m = rng.uniform(-spread_m, spread_m, (count, 2)).astype(np.float32)
    square_m = rng.uniform(-spread_m, spread_m, (count, 2)).astype(np.float32)
    images = {
        "above": _pictures(square_m / 1.3, rng),
        "wrist": _pictures((square_m - hand_m) / 2.6, rng),
    }
    labels = ACTION.maximum * np.clip(square_m - hand_m, -1, 1)
    return Samples(images, hand_m, labels.astype(np.float32), np.arange(count) // 50)


def _pictures(places: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Noise, and a red square of 7 px at (n, 2) places, each -1..1 over the picture."""
    pictures = rng.integers(90, 110, (len(places), SIDE_PX, SIDE_PX, 3), dtype=np.uint8)
    corners = np.round((places + 1) / 2 * (SIDE_PX - 7)).astype(int)
    for picture, (column, row) in zip(pictures, corners, strict=True):
        picture[row : row + 7, column : column + 7] = (200, 40, 40)
    return pictures


@cache
def training() -> Samples:
    return reach_samples(400, seed=0)


@cache
def held_out() -> Samples:
    return reach_samples(200, seed=1)


@cache
def fitted_policy(name: str = "spatial-cnn") -> TrainablePolicy:
    """Fitted once for all tests, which must not fit it again."""
    if name == "act":
        # Of states that do not follow one another there is no chunk to learn.
        apart = replace(training(), episodes=np.arange(len(training())))
        return make_policy(name, SPEC, seed=0, **ACT_SETTINGS).fit(apart)
    return make_policy(name, SPEC, seed=0, **SETTINGS).fit(training())
