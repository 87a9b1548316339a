"""HG-DAgger's gate: the human decides when to take over; only human steps are labelled.

Kelly et al. 2019, 'HG-DAgger: Interactive imitation learning with human experts' (ICRA).
"""

from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Expert
from sheath_manip.types import (
    Action,
    ActionSpec,
    Actor,
    GateDecision,
    Observation,
    Proposal,
    Reason,
)


class Person(Protocol):
    """Watches the policy and takes over where it wants to."""

    def reset(self) -> None:
        """Forget the last episode."""
        ...

    def wants(self, observation: Observation, proposed: Action) -> bool:
        """Return whether the person drives this step."""
        ...


class HumanGate:
    """The expert acts where the person wants it to, and labels those steps alone."""

    def __init__(self, person: Person) -> None:
        self.person = person

    def reset(self, rng: np.random.Generator) -> None:
        """A new episode for the person too."""
        del rng
        self.person.reset()

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Ask the person; the expert without asking where there is no proposal."""
        if proposal is None:
            return GateDecision(Actor.EXPERT, True, Reason.INVALID_PROPOSAL)
        wants = bool(self.person.wants(observation, proposal.now[0]))
        return GateDecision(Actor.EXPERT if wants else Actor.POLICY, wants, Reason.PERSON)


class ScriptedPerson:
    """Stands in for a person: an attentive one, who knows what the expert would do.

    Takes over where the policy would do otherwise, and drives on for a while.
    """

    def __init__(self, expert: Expert, tolerance: ArrayLike = 1e-6, hold_steps: int = 0) -> None:
        """Store what the person knows and how patient it is.

        Args:
            expert: asked at every step, so it must not mind to be asked again by the rollout.
            tolerance: largest difference of each dimension of the action, in its own unit, that
                passes; a number for all or (a,) one each.
            hold_steps: that the person drives on after the last difference.
        """
        if not (np.greater_equal(tolerance, 0).all() and hold_steps >= 0):
            raise ParameterError(
                f"tolerance is {tolerance}, hold_steps {hold_steps}; wanted each at least 0"
            )
        self.expert = expert
        self.tolerance = np.asarray(tolerance)
        self.hold_steps = hold_steps
        self._left = 0

    def reset(self) -> None:
        """Let the policy have the wheel."""
        self._left = 0

    def wants(self, observation: Observation, proposed: Action) -> bool:
        """Return whether the expert would do otherwise now, or would have a moment ago."""
        apart = np.abs(self.expert.act(observation) - proposed)
        if (apart > self.tolerance).any():
            self._left = self.hold_steps
            return True
        self._left -= 1
        return self._left >= 0


class Nobody:
    """Never takes over."""

    def reset(self) -> None:
        """Do nothing: there is nobody to tell."""

    def wants(self, observation: Observation, proposed: Action) -> bool:  # noqa: ARG002
        """Return False: nobody ever takes over."""
        return False


def attentive_person(expert: Expert, action: ActionSpec) -> ScriptedPerson:
    """Return a person who lets pass what the task counts as the same action, and nothing else."""
    return ScriptedPerson(expert, 1e-6 + action.tolerance * (action.maximum - action.minimum))
