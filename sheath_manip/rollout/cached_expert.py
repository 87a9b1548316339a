"""An expert that may be asked more than once in a step."""

from sheath_manip.protocols import Expert, Follows, TakesOver
from sheath_manip.types import Action, Observation


class CachedExpert:
    """An expert that remembers its last answer: asked again in the same step it does not think."""

    def __init__(self, expert: Expert) -> None:
        self.expert = expert
        self._last: tuple[Observation, Action] | None = None

    def reset(self) -> None:
        """Forget the last episode."""
        self._last = None
        self.expert.reset()

    def follow(self, observation: Observation) -> None:
        """Pass on, where the expert wants to know."""
        if isinstance(self.expert, Follows):
            self.expert.follow(observation)

    def take_over(self, observation: Observation) -> None:
        """Pass on, where the expert wants to know; what it said before is no longer its answer."""
        if isinstance(self.expert, TakesOver):
            self._last = None
            self.expert.take_over(observation)

    def act(self, observation: Observation) -> Action:
        """(a,) what the expert would do; the very same observation object is the same step."""
        if self._last is None or self._last[0] is not observation:
            self._last = (observation, self.expert.act(observation))
        return self._last[1]
