"""The environment as the loop sees it: guarded, checked, and in nobody else's hands."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Environment, Holds, Restorable
from sheath_manip.protocols.environment import require_restorable
from sheath_manip.rollout.checking import (
    kept_metrics,
    kept_observation,
    kept_outcome,
    kept_state,
    kept_transition,
)
from sheath_manip.rollout.guard import ask
from sheath_manip.types import Action, Observation, Outcome, Transition

ENVIRONMENT = "environment"
NO_STATE = np.zeros(0)
"""of an environment that cannot be restored"""


class Stage:
    """Asks an environment; every method raises BrokenError where it fails or answers rubbish."""

    def __init__(self, environment: Environment) -> None:
        self.environment = environment
        self.spec = ask(ENVIRONMENT, lambda: environment.spec)
        self._restorable = environment if isinstance(environment, Restorable) else None
        self._state_size: int | None = None

    def reset(self, seed: int) -> Observation:
        """Start the episode that belongs to `seed`."""
        return ask(ENVIRONMENT, self._reset, seed)

    def restore(self, state: NDArray[np.float64]) -> Observation:
        """Continue from a state of the episode that was started.

        Raises ParameterError where the environment cannot.
        """
        restorable = require_restorable(self.environment, "episodes that go on from a state")
        # A copy, which it may change as it likes.
        return ask(
            ENVIRONMENT,
            lambda: kept_observation(restorable.restore(state.copy()), self.spec),
        )

    def state(self) -> NDArray[np.float64]:
        """(s,) the simulator's state; (0,) of one that cannot be restored."""
        return ask(ENVIRONMENT, self._state)

    def step(self, action: Action) -> Transition:
        """Run one control step."""
        return ask(ENVIRONMENT, self._step, action)

    def outcome(self) -> Outcome:
        """Return how the episode stands."""
        return ask(ENVIRONMENT, lambda: kept_outcome(self.environment.outcome()))

    def metrics(self) -> Mapping[str, float]:
        """The episode's figures so far."""
        return ask(ENVIRONMENT, lambda: kept_metrics(self.environment.metrics()))

    def hold(self) -> None:
        """Let the environment bring the robot to rest by itself, where it can."""
        if isinstance(self.environment, Holds):
            self.environment.hold()

    def _reset(self, seed: int) -> Observation:
        return kept_observation(self.environment.reset(seed), self.spec)

    def _state(self) -> NDArray[np.float64]:
        if self._restorable is None:
            return NO_STATE
        kept = kept_state(self._restorable.state(), self._state_size)
        self._state_size = kept.size
        return kept

    def _step(self, action: Action) -> Transition:
        # A copy, which it may change as it likes.
        return kept_transition(self.environment.step(action.copy()), self.spec)
