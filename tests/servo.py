"""A toy task of features alone: bring a hand to a place, by continuous actions."""

from functools import cache

import numpy as np

from sheath_manip.policies import make_policy
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.types import ActionSpec, TaskSpec
from sheath_manip.types.samples import Samples

ACTION = ActionSpec(
    ("velocity_x_m_s", "velocity_y_m_s"),
    np.array([-0.2, -0.1], np.float32),
    np.array([0.2, 0.1], np.float32),
    tolerance=0.1,
)
SPEC = TaskSpec(
    name="servo",
    control_rate_hz=20.0,
    action=ACTION,
    cameras={},
    feature_names=("hand_x_m", "hand_y_mm", "place_x_m", "place_y_mm"),
    max_steps=100,
    metric="steps",
)
SETTINGS = {"hidden": (64, 64), "steps": 800, "learning_rate": 3e-3}
"""with which the toy is learned in a second"""


def servo_samples(count: int, seed: int) -> Samples:
    """Hand and place anywhere; 50 states an episode.

    Along y all is a thousand times as large, which only a policy that scales its features survives.
    """
    rng = np.random.default_rng(seed)
    hand, place = rng.uniform(-1, 1, (2, count, 2))
    labels = ACTION.maximum * np.clip(place - hand, -1, 1)
    features = np.concatenate([hand, place], axis=1) * np.array([1, 1e3, 1, 1e3])
    return Samples(
        {}, features.astype(np.float32), labels.astype(np.float32), np.arange(count) // 50
    )


@cache
def training() -> Samples:
    return servo_samples(500, seed=0)


@cache
def held_out() -> Samples:
    return servo_samples(200, seed=1)


@cache
def fitted_policy() -> TrainablePolicy:
    """Fitted once for all tests, which must not fit it again."""
    return make_policy("mlp", SPEC, seed=0, **SETTINGS).fit(training())
