"""What a task must offer to be run."""

from collections.abc import Mapping, Sequence
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import (
    Action,
    Observation,
    Outcome,
    SceneGeom,
    ScenePose,
    TaskSpec,
    Transition,
)


class Environment(Protocol):
    """A seeded task: the same seed and actions give the same episode to the bit.

    This is all that the loop needs; an environment that can do more is `Restorable`, `Viewable`, or
    `Holds`.
    """

    @property
    def spec(self) -> TaskSpec:
        """The task's constant description."""
        ...

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed`."""
        ...

    def step(self, action: Action) -> Transition:
        """Run one control step."""
        ...

    def outcome(self) -> Outcome:
        """Return how the episode stands: TIME_LIMIT until it succeeds or fails."""
        ...

    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far, `spec.metric` among them."""
        ...

    def close(self) -> None:
        """Free what the simulator and its renderer hold."""
        ...


@runtime_checkable
class Restorable(Protocol):
    """An environment whose state can be read and returned to, as replay and probes want it.

    The steps of one without this are recorded with an empty state.
    """

    def state(self) -> NDArray[np.float64]:
        """(s,) the whole simulator state."""
        ...

    def restore(self, state: NDArray[np.float64]) -> Observation:
        """Continue from a `state()` of an episode with the present seed."""
        ...


@runtime_checkable
class Viewable(Protocol):
    """An environment whose shapes can be shown in 3-D.

    Of one without this pages and films show what its cameras see.
    """

    def scene(self) -> Sequence[SceneGeom]:
        """The visible shapes, constant between resets."""
        ...

    def pose(self) -> ScenePose:
        """Return how the scene stands now."""
        ...

    def pose_at(self, state: NDArray[np.float64]) -> ScenePose:
        """Return how the scene stood in `state`, at which the episode then stands.

        Nothing is observed.
        """
        ...


@runtime_checkable
class Holds(Protocol):
    """An environment that brings its robot to rest by itself, such as one with a robot behind it.

    One without this is a simulation, in which nothing moves between two steps.
    """

    def hold(self) -> None:
        """Bring the robot to rest and keep it there until the next step.

        Called where a run is cut short, and from another thread where a call hangs.
        """
        ...


def require_restorable(environment: Environment, wish: str) -> Restorable:
    """Return the environment where it is `Restorable`; raises ParameterError where it is not.

    `wish` says what its states are wanted for, such as `displaced states`.
    """
    if isinstance(environment, Restorable):
        return environment
    raise ParameterError(
        f"{wish} want an environment that can be restored; {type(environment).__name__} has no "
        "state() and restore()"
    )
