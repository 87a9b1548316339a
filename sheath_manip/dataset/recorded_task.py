"""The task that recordings are of, as far as they tell: enough to check what is seen and done."""

import numpy as np

from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.types import ActionSpec, TaskSpec

UNBOUNDED = np.finfo(np.float32).max


def task_of(recorded: RecordedSpec) -> TaskSpec:
    """Return the spec of the task; what recordings do not tell is numbered, and has no bounds.

    They tell neither the time limit, which is 0, nor the metric, which is empty.
    """
    space = recorded.space
    if space is None:
        size = recorded.action_size
        names = tuple(f"action {place}" for place in range(size))
        action = ActionSpec(names, _numbers([-UNBOUNDED] * size), _numbers([UNBOUNDED] * size))
        features = tuple(f"feature {place}" for place in range(recorded.feature_size))
    else:
        choices = None if space.action_choices is None else _numbers(space.action_choices)
        bounds = _numbers(space.action_minimum), _numbers(space.action_maximum)
        action = ActionSpec(space.action_names, *bounds, choices)
        features = space.feature_names
    return TaskSpec(
        name=recorded.task,
        control_rate_hz=recorded.control_rate_hz,
        action=action,
        cameras=recorded.cameras,
        feature_names=features,
        max_steps=0,
        metric="",
    )


def _numbers(values: object) -> np.ndarray:
    return np.asarray(values, np.float32)
