"""Who acts in somebody else's environment: what acts on its own observations, and rest."""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.adapters.gymnasium_environment import GymnasiumEnvironment
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Action, Observation


class GymnasiumExpert:
    """The user's expert, a function or a class, asked with the observations of its environment."""

    def __init__(self, asked: Callable[[Any], Any] | None, environment: GymnasiumEnvironment):
        """`asked` acts on an observation, or is a class of what has `act`, from the environment.

        Raises ParameterError where there is none.
        """
        if asked is None:
            raise ParameterError(f"{environment.spec.name} has no expert; wanted expert=")
        self._environment = environment
        self._expert = asked(environment.gym.unwrapped) if isinstance(asked, type) else None
        self._act = asked if self._expert is None else self._expert.act

    def reset(self) -> None:
        """Let it forget, where it remembers."""
        if hasattr(self._expert, "reset"):
            self._expert.reset()  # pyright: ignore[reportOptionalMemberAccess]

    def act(self, observation: Observation) -> Action:
        """Ask it, with what its environment shows at that moment."""
        del observation
        return self._environment.terms.actions.taken(self._act(self._environment.seen))


class Rest:
    """Leaves the robot where it is, by one action for ever."""

    def __init__(self, action: NDArray[np.float32], environment: GymnasiumEnvironment) -> None:
        self._action = environment.terms.actions.taken(
            np.broadcast_to(action, environment.spec.action.minimum.shape)
        )

    def reset(self) -> None:
        """Nothing to forget."""

    def act(self, observation: Observation) -> Action:
        """Return that action."""
        del observation
        return self._action.copy()
