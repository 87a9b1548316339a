"""What every expert must do, and every controller that acts in its place."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.protocols import Environment, Expert, Follows, Restorable, TakesOver
from sheath_manip.testing.sentences import wants, wants_equal

STEPS = 8


def check_expert(make: Callable[[Any], Expert], environment: Environment) -> None:
    """Check what acts in `environment`: its actions are valid, and the same for the same seed.

    Asking must not change the physics. `make` is called with the environment, as a task's expert.
    """

    def driven() -> list[Any]:
        expert, observation = make(environment), environment.reset(3)
        expert.reset()
        actions = []
        for _ in range(STEPS):
            if isinstance(expert, Follows):
                expert.follow(observation)
            if not actions and isinstance(expert, TakesOver):
                expert.take_over(observation)
            before = _state_of(environment)
            action = expert.act(observation)
            sentence = "asking an expert must not change the state"
            wants_equal(_state_of(environment), before, sentence)
            actions.append(environment.spec.action.validated(action))
            transition = environment.step(action)
            observation = transition.observation
            if transition.terminated or transition.truncated:
                break
        return actions

    first, again = driven(), driven()
    wants(len(first) == len(again), "the same seed must give an episode of the same length")
    for one, other in zip(first, again, strict=True):
        wants_equal(other, one, "the same seed must give the same actions")


def _state_of(environment: Environment) -> NDArray[np.float64]:
    return environment.state() if isinstance(environment, Restorable) else np.zeros(0)
