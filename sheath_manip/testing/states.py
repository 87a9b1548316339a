"""States and labels drawn at random for a task, of which only the spec is known."""

import numpy as np

from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples


def drawn_states(spec: TaskSpec, count: int = 60, seed: int = 0) -> Samples:
    """Return `count` states with labels that depend on what is seen; 20 states an episode.

    Pictures are noise on a brightness, features are normal, and a label follows from both, so that
    a policy has something to learn.
    """
    rng = np.random.default_rng(seed)
    bright = rng.uniform(0, 1, count)
    images = {
        camera: np.clip(
            40 + 150 * bright[:, None, None, None] + rng.normal(0, 12, (count, *shape, 3)), 0, 255
        ).astype(np.uint8)
        for camera, shape in spec.cameras.items()
    }
    features = rng.normal(size=(count, len(spec.feature_names))).astype(np.float32)
    if features.shape[1]:
        features[:, 0] = 2 * bright - 1
    action = spec.action
    if action.choices is not None:
        chosen = np.minimum((bright * len(action.choices)).astype(int), len(action.choices) - 1)
        labels = action.choices[chosen]
    else:
        span = action.maximum - action.minimum
        labels = action.minimum + (0.2 + 0.6 * bright[:, None]) * span
    return Samples(images, features, np.asarray(labels, np.float32), np.arange(count) // 20)
