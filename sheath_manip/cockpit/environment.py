"""An environment whose episodes a person may end."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sheath_manip.cockpit.cockpit import Cockpit, Ending
from sheath_manip.protocols import Environment
from sheath_manip.rollout.discarding import DiscardedError
from sheath_manip.types import (
    Action,
    Observation,
    Outcome,
    SceneGeom,
    ScenePose,
    TaskSpec,
    Transition,
)


class OperatedEnvironment:
    """The environment that it is given, until the person says that the episode is over."""

    def __init__(self, environment: Environment, cockpit: Cockpit) -> None:
        self.environment = environment
        self.cockpit = cockpit

    @property
    def spec(self) -> TaskSpec:
        """The task's constant description."""
        return self.environment.spec

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed`."""
        self.cockpit.begin_episode()
        return self.environment.reset(seed)

    def step(self, action: Action) -> Transition:
        """Run one control step; raises DiscardedError where the person wants no more of it."""
        if self.cockpit.ending is Ending.DISCARD:
            raise DiscardedError("the person has discarded the episode")
        transition = self.environment.step(action)
        if self.cockpit.ending is None or transition.terminated:
            return transition
        marked = self.cockpit.mark is not None
        return replace(transition, terminated=marked, truncated=not marked)

    def outcome(self) -> Outcome:
        """What the person said it is, else the task."""
        return self.cockpit.mark or self.environment.outcome()

    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far."""
        return self.environment.metrics()

    def state(self) -> NDArray[np.float64]:
        """(s,) the whole simulator state."""
        return self.environment.state()

    def restore(self, state: NDArray[np.float64]) -> Observation:
        """Continue from a `state()`."""
        return self.environment.restore(state)

    def scene(self) -> Sequence[SceneGeom]:
        """The visible shapes."""
        return self.environment.scene()

    def pose(self) -> ScenePose:
        """How the scene stands now."""
        return self.environment.pose()

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        """How it stood in `state`."""
        return self.environment.pose_at(state)

    def close(self) -> None:
        """Free what the simulator holds."""
        self.environment.close()
