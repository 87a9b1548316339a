"""An environment without a simulator: one array is all of its state."""

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sheath_manip.types import Observation


class ArrayEnvironment(ABC):
    """Base of such environments: what follows from `at`, the state, is here.

    It has no shapes to show; `Task(picture=...)` makes films all the same. What is
    left to a task: `spec`, `reset`, `step`, `observe`, `outcome` and `metrics`.
    """

    at: NDArray[np.float64]
    """(s,) the whole state"""

    @abstractmethod
    def observe(self) -> Observation:
        """Return what is seen at `at`."""

    def state(self) -> NDArray[np.float64]:
        """(s,) a copy of the whole state."""
        return self.at.copy()

    def restore(self, state: ArrayLike) -> Observation:
        """Continue from a `state()` of an episode with the present seed."""
        self.at = np.array(state, np.float64)
        return self.observe()

    def close(self) -> None:
        """Return at once: there is nothing to free."""
        return
