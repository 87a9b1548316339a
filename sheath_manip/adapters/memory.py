"""What it takes to return to a moment of somebody else's environment."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from sheath_manip.adapters.mujoco_simulation import MujocoSimulation

Save = Callable[[Any], NDArray[np.float64]]
"""(s,) what an unwrapped environment remembers"""
Load = Callable[[Any, NDArray[np.float64]], Any]
"""put an unwrapped environment back into such a state; the answer is its observation there"""


class Memory(Protocol):
    """Reads what an environment remembers of an episode, and takes it back there."""

    def read(self) -> NDArray[np.float64]:
        """(s,) the present moment."""
        ...

    def write(self, state: NDArray[np.float64]) -> Any:
        """Return to that moment; the answer is what gymnasium calls an observation of it."""
        ...


@dataclass(frozen=True)
class OwnMemory:
    """The user's own pair of functions."""

    environment: Any
    save: Save
    load: Load

    def read(self) -> NDArray[np.float64]:
        """Save."""
        return np.asarray(self.save(self.environment), np.float64).ravel()

    def write(self, state: NDArray[np.float64]) -> Any:
        """Load."""
        return self.load(self.environment, state)


@runtime_checkable
class Remembers(Protocol):
    """An environment that remembers more than its simulator's state."""

    def memory(self) -> NDArray[np.float64]:
        """(m,) the rest of it; always as long."""
        ...

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Take such a memory back."""
        ...


@dataclass(frozen=True)
class MujocoMemory:
    """The simulator's state, and the goal where the environment has one."""

    simulation: "MujocoSimulation"

    def read(self) -> NDArray[np.float64]:
        """Read both."""
        return np.concatenate([self._rest(), self.simulation.state()])

    def write(self, state: NDArray[np.float64]) -> Any:
        """Write both, and observe."""
        environment: Any = self.simulation.environment
        size = len(self._rest())
        self.simulation.restore(state[size:])
        self._recall(environment, state[:size])
        return environment._get_obs()

    def _recall(self, environment: Any, rest: NDArray[np.float64]) -> None:
        if isinstance(environment, Remembers):
            environment.recall(rest)
        elif rest.size:
            environment.goal = rest.reshape(environment.goal.shape)

    def _rest(self) -> NDArray[np.float64]:
        environment = self.simulation.environment
        if isinstance(environment, Remembers):
            return environment.memory()
        goal = getattr(environment, "goal", None)
        return goal.astype(np.float64).ravel() if isinstance(goal, np.ndarray) else np.zeros(0)
