"""One episode of the toy corridor, driven by who acts and proposes as the test says."""

from collections.abc import Callable, Mapping
from typing import cast

import numpy as np

from sheath_manip.protocols import Expert, Gate, Listener, Policy
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.watch import Deadline
from sheath_manip.types import (
    Action,
    Actor,
    Episode,
    EpisodeInfo,
    Observation,
    Observations,
    Proposal,
    Purpose,
)
from tests.toy import CHOICES, Corridor

SEED = 4


class Scripted:
    """Acts as it is told, and counts how often it is asked."""

    def __init__(self, answer: Callable[[int], object]) -> None:
        self.answer = answer
        self.asked = 0
        self.resets = 0

    def reset(self) -> None:
        self.resets += 1

    def act(self, observation: Observation) -> Action:
        del observation
        self.asked += 1
        return cast(Action, self.answer(self.asked - 1))


class Saying:
    """A policy that proposes what it is told."""

    def __init__(self, answer: Callable[[int], object]) -> None:
        self.answer = answer
        self.asked = 0
        self.drew: list[float] = []

    def reset(self, rng: np.random.Generator) -> None:
        """Draw nothing."""

    def propose(self, observations: Observations) -> Proposal:
        assert len(observations) == 1
        self.asked += 1
        # A list, since not all that is tried here makes an array.
        return Proposal(cast(np.ndarray, [self.answer(self.asked - 1)]))


def run(
    gate: Gate,
    policy: Policy | None = None,
    expert: Expert | None = None,
    listeners: tuple[Listener, ...] = (),
    environment: Corridor | None = None,
    others: Mapping[Actor, Expert] | None = None,
    seed: int = SEED,
    deadline: Deadline | None = None,
) -> Episode:
    return rollout(
        environment or Corridor(),
        EpisodeInfo("corridor", seed, Purpose.LEARNING, 50.0),
        gate,
        rng=np.random.default_rng(0),
        policy=policy,
        expert=expert,
        others=others or {},
        listeners=listeners,
        deadline=deadline,
    )


def still() -> Saying:
    """Proposes to stay: what the keeper of the middle says only now and then."""
    return Saying(lambda _: CHOICES[1])
