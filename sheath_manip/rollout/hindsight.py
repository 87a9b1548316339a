"""Labels of the last moments before a failure: what should have been done is worth most there.

Nobody knows of a failure before it comes. So the expert is asked all along, in silence, and what it
said is kept for the last steps alone, where the episode failed.
"""

from collections import deque
from collections.abc import Sequence
from dataclasses import replace

from sheath_manip.rollout.actors import Actors
from sheath_manip.rollout.guard import BrokenError
from sheath_manip.types import Action, Observation, Outcome, Step


class Hindsight:
    """Remembers what the expert would have done in the last steps of an episode."""

    def __init__(self, steps: int) -> None:
        """Store how many of the last steps are labelled where the episode fails."""
        self.steps = steps
        self._answers: deque[tuple[int, Action]] = deque(maxlen=steps)

    def ask(self, step: int, actors: Actors, observation: Observation) -> None:
        """Ask about a step in which the policy acts and nobody wants a label yet."""
        try:
            self._answers.append((step, actors.label(observation)))
        except BrokenError:
            # As everywhere: a state more or less without a label does no harm.
            return

    def labelled(self, steps: Sequence[Step], outcome: Outcome) -> list[Step]:
        """Return the episode's steps, where it failed with labels of the last of them."""
        found = list(steps)
        if outcome is not Outcome.FAILURE:
            return found
        for at, action in self._answers:
            if at >= len(found) - self.steps:
                decision = replace(found[at].decision, query=True)
                found[at] = replace(found[at], labelled=action, decision=decision)
        return found
