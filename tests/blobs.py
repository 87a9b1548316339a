"""A toy task for the learning parts: steer towards the red square in a grey picture."""

from functools import cache

import numpy as np
import torch

from sheath_manip.adapters.from_torch import from_torch
from sheath_manip.policies import make_policy
from sheath_manip.protocols import PredictingPolicy, TrainablePolicy
from sheath_manip.types import ActionSpec, Observation, Observations, TaskSpec
from sheath_manip.types.samples import Samples

CHOICES = np.radians([[-15.0], [0.0], [15.0]]).astype(np.float32)
ACTION = ActionSpec(("steering_rad",), CHOICES[0], CHOICES[-1], CHOICES)
SPEC = TaskSpec("blobs", 8.0, ACTION, {"top": (125, 125)}, ("x_m",), 100, "steps")


def blob_samples(count: int, seed: int, choices: tuple[int, ...] = (0, 1, 2)) -> Samples:
    """Squares left, in the middle or right, jittered over noise; 50 states an episode."""
    rng = np.random.default_rng(seed)
    images = rng.integers(90, 110, (count, 125, 125, 3), dtype=np.uint8)
    chosen = rng.choice(choices, count)
    for image, choice in zip(images, chosen, strict=True):
        column = 20 + 35 * choice + rng.integers(-6, 7)
        row = 50 + rng.integers(-20, 20)
        image[row : row + 20, column : column + 20] = (200, 40, 40)
    features = np.zeros((count, 1), dtype=np.float32)
    return Samples({"top": images}, features, CHOICES[chosen], np.arange(count) // 50)


def observation_of(samples: Samples, index: int) -> Observation:
    return Observation({"top": samples.images["top"][index]}, samples.features[index], 0.0)


@cache
def training() -> Samples:
    return blob_samples(300, seed=0)


@cache
def held_out() -> Samples:
    return blob_samples(200, seed=1)


@cache
def fitted_policy(name: str) -> TrainablePolicy:
    """Fitted once for all tests, which must not fit it again."""
    # A red square is learned soon; sooner, and what else is known of it hangs on the last bits.
    short = {"epochs": 20} if name.endswith("cnn") else {}
    return make_policy(name, SPEC, seed=0, **short).fit(training())


@cache
def hidden_layer() -> PredictingPolicy:
    """Somebody's module, whose first layer gives (n, 3, 4) of each image."""
    first = torch.nn.Sequential(torch.nn.AdaptiveAvgPool2d((4, 1)), torch.nn.Flatten(2))
    torch.manual_seed(0)
    module = torch.nn.Sequential(first, torch.nn.Flatten(), torch.nn.Linear(12, 3))
    return from_torch(module, embed="0", inputs=_channels_first, action=ACTION)


def _channels_first(observations: Observations) -> np.ndarray:
    return np.moveaxis(observations.images["top"], 3, 1).astype(np.float32)
