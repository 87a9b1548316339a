"""A stand-in for an expert that is missing: stand still until the person is there."""

from collections.abc import Callable

from sheath_manip.types import Action, Observation


class Hold:
    """Asks for nothing; how gently the robot comes to rest is up to its command filter."""

    def __init__(self, rest: Callable[[], Action]) -> None:
        """`rest` gives the (a,) action that leaves everything as it is now."""
        self._rest = rest

    def reset(self) -> None:
        """Do nothing: there is nothing to forget."""

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """(a,) the action that changes nothing."""
        return self._rest()
