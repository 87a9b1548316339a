"""HG-DAgger's gate: the human decides when to take over; only human steps are labelled.

Kelly et al. 2019, 'HG-DAgger: Interactive imitation learning with human experts' (ICRA).
"""

from typing import Protocol

import numpy as np

from sheath_manip.types import (
    Action,
    Actor,
    GateDecision,
    Observation,
    Proposal,
    Reason,
)


class Person(Protocol):
    """Watches the policy and takes over where it wants to."""

    def reset(self, rng: np.random.Generator) -> None:
        """Forget the last episode; all that is drawn comes from `rng`."""
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
        self.person.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Ask the person; the expert without asking where there is no proposal."""
        if proposal is None:
            return GateDecision(Actor.EXPERT, True, Reason.INVALID_PROPOSAL)
        wants = bool(self.person.wants(observation, proposal.now[0]))
        return GateDecision(Actor.EXPERT if wants else Actor.POLICY, wants, Reason.PERSON)


class Nobody:
    """Never takes over."""

    def reset(self, rng: np.random.Generator) -> None:
        """Do nothing: there is nobody to tell."""

    def wants(self, observation: Observation, proposed: Action) -> bool:  # noqa: ARG002
        """Return False: nobody ever takes over."""
        return False
