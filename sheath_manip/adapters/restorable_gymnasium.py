"""A gymnasium environment that can be returned to a moment."""

from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from sheath_manip.adapters.gymnasium_environment import GymnasiumEnvironment, Terms
from sheath_manip.adapters.memory import Memory
from sheath_manip.types import Observation, Outcome

_OUTCOMES = tuple(Outcome)


class RestorableGymnasium(GymnasiumEnvironment):
    """One whose memory can be read and written; wrappers may keep count of steps, and no more."""

    def __init__(self, gym: gymnasium.Env, terms: Terms, memory: Memory) -> None:
        super().__init__(gym, terms)
        self._memory = memory

    def state(self) -> NDArray[np.float64]:
        """(s,) how far the episode is and how it stands, then what the environment remembers."""
        outcome = _OUTCOMES.index(self._outcome)
        return np.concatenate(
            [[self._steps, outcome, self._successes, self._return], self._memory.read()]
        )

    def restore(self, state: NDArray[np.float64]) -> Observation:
        """Continue from a `state()` of an episode with the present seed."""
        seen = self._take(state)
        for wrapper in _layers(self.gym):
            # As gymnasium's ObservationWrapper has it, from the inside to the outside.
            if isinstance(wrapper, gymnasium.ObservationWrapper):
                seen = wrapper.observation(seen)
        self.seen = seen
        return self._observed()

    def _take(self, state: NDArray[np.float64]) -> Any:
        steps, outcome, successes, self._return = (float(each) for each in state[:4])
        self._steps, self._successes = int(steps), int(successes)
        self._outcome = _OUTCOMES[int(outcome)]
        for wrapper in _layers(self.gym):
            # Of gymnasium's TimeLimit.
            if hasattr(wrapper, "_elapsed_steps"):
                wrapper._elapsed_steps = self._steps
        return self._memory.write(np.array(state[4:]))


def _layers(gym: gymnasium.Env) -> Iterator[Any]:
    """The wrappers around an environment, from the inside to the outside."""
    if isinstance(gym, gymnasium.Wrapper):
        yield from _layers(gym.env)
        yield gym
