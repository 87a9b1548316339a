"""What a task shows and takes, as gymnasium's spaces."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from sheath_manip.exceptions import ActionError
from sheath_manip.types import Action, ActionSpec, Observation, TaskSpec

FEATURES = "features"
"""the key of what is measured, beside the cameras' names"""


@dataclass(frozen=True)
class TaskSpaces:
    """How observations and actions of a task stand in gymnasium's spaces."""

    spec: ActionSpec
    action: spaces.Box | spaces.Discrete
    """Discrete where the task's actions are choices: the place of the choice"""
    observation: spaces.Box | spaces.Dict
    """a Dict of `features` and one image a camera, or the features alone where there is none"""

    @classmethod
    def of(cls, spec: TaskSpec) -> Self:
        """Return the spaces of the task."""
        choices = spec.action.choices
        action = (
            spaces.Box(spec.action.minimum, spec.action.maximum, dtype=np.float32)
            if choices is None
            else spaces.Discrete(len(choices))
        )
        features = spaces.Box(-np.inf, np.inf, (len(spec.feature_names),), np.float32)
        images = {
            camera: spaces.Box(0, 255, (height, width, 3), np.uint8)
            for camera, (height, width) in spec.cameras.items()
        }
        if not images:
            return cls(spec.action, action, features)
        measured = {FEATURES: features} if spec.feature_names else {}
        return cls(spec.action, action, spaces.Dict({**measured, **images}))

    def seen(self, observation: Observation) -> Any:
        """Return an observation as one of the space, copied."""
        if isinstance(self.observation, spaces.Box):
            return observation.features.copy()
        found: dict[str, NDArray] = {**observation.images, FEATURES: observation.features}
        return {name: found[name].copy() for name in self.observation}

    def taken(self, action: Any) -> Action:
        """(a,) of an action of the space; raises ActionError where it is none."""
        if self.spec.choices is None:
            return self.spec.validated(action)
        if not (isinstance(action, int | np.integer | np.ndarray) and action in self.action):
            raise ActionError(f"the action is {action}; wanted one of 0 .. {self.action.n - 1}")  # pyright: ignore[reportAttributeAccessIssue]
        return self.spec.choices[int(action)]

    def shown(self, action: Action) -> Any:
        """Return an (a,) action as one of the space; of choices the place of the nearest."""
        if self.spec.choices is None:
            return action.copy()
        distances = np.abs(self.spec.choices - action).sum(axis=1)
        return int(np.argmin(distances))
