"""A stretch of an episode: where one task fails so often that no episode ends well, it is a scene.

A gate that may ask once an episode cannot save an episode in which the policy fails ten times.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Environment
from sheath_manip.protocols.environment import require_restorable
from sheath_manip.types import (
    Action,
    Episode,
    EpisodeInfo,
    Observation,
    Outcome,
    Step,
    TaskSpec,
    Transition,
)


@dataclass(frozen=True, eq=False)
class Stretch:
    """What the policy did alone in a scene: an episode from some step on, or all of it."""

    info: EpisodeInfo
    steps: Sequence[Step]
    outcome: Outcome
    most: int | None = None
    """steps after which the scene is over, and well; None: when the task says so"""

    @classmethod
    def of(cls, episode: Episode, first_step: int, most: int | None) -> Self:
        """Return the stretch of `most` steps from `first_step` on, all of the episode for None."""
        if most is None:
            return cls(episode.info, episode.steps, episode.outcome)
        steps = episode.steps[first_step : first_step + most]
        fails = first_step + most > len(episode) and episode.outcome is Outcome.FAILURE
        return cls(episode.info, steps, Outcome.FAILURE if fails else Outcome.SUCCESS, most)

    def __len__(self) -> int:
        return len(self.steps)


class StretchEnvironment:
    """An environment in which to get through a number of steps is to succeed.

    What experts and holds ask of the task's own environment it passes on.
    """

    def __init__(self, environment: Environment) -> None:
        self.environment = environment
        self._restorable = require_restorable(environment, "scenes that begin in an episode")
        self.steps_left: int | None = None
        """of the present scene; None: until the task says that it is over"""

    def __getattr__(self, name: str) -> Any:
        return getattr(self.environment, name)

    @property
    def spec(self) -> TaskSpec:
        """The task's."""
        return self.environment.spec

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed`."""
        return self.environment.reset(seed)

    def step(self, action: Action) -> Transition:
        """Run one control step."""
        transition = self.environment.step(action)
        if self.steps_left is None or transition.terminated:
            return transition
        self.steps_left -= 1
        return replace(transition, truncated=transition.truncated or self.steps_left == 0)

    def outcome(self) -> Outcome:
        """Return how the scene stands."""
        outcome = self.environment.outcome()
        through = self.steps_left == 0 and outcome is Outcome.TIME_LIMIT
        return Outcome.SUCCESS if through else outcome

    def state(self) -> NDArray[np.float64]:
        """(s,) the whole simulator state."""
        return self._restorable.state()

    def restore(self, state: NDArray[np.float64]) -> Observation:
        """Continue from a `state()` of the present episode."""
        return self._restorable.restore(state)

    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far."""
        return self.environment.metrics()

    def close(self) -> None:
        """Close the environment."""
        self.environment.close()
