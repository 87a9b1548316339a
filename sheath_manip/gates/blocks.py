"""Random blocks: takeovers as many and as long as a gate's, at times that look at nothing.

What a person feels is how often it is called. So this is the baseline that tells what a gate's
choice of moments is worth: the burden is the gate's, and only the moments are drawn.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason


@dataclass(frozen=True)
class BlocksConfig:
    """How often random blocks come, and how long they are."""

    rate: float = 0.0
    """probability, 0 .. 1, that a block begins in a step before which the policy drove"""
    steps: tuple[int, ...] = ()
    """lengths of blocks, of which each block has one, drawn"""

    def __post_init__(self) -> None:
        if not 0 <= self.rate <= 1:
            raise ParameterError(f"rate is {self.rate}; wanted a probability in 0 .. 1, like 0.02")
        if not all(steps >= 1 for steps in self.steps):
            raise ParameterError(f"steps are {self.steps}; wanted each at least 1")
        if self.rate > 0 and not self.steps:
            raise ParameterError(
                f"rate is {self.rate}, but steps is empty; wanted lengths, like 10"
            )

    @classmethod
    def like(cls, turns: Sequence[Sequence[int]], policy_steps: int) -> Self:
        """Return blocks as frequent and as long as the takeovers of some episodes.

        Args:
            turns: the lengths of the takeovers of each episode, in steps.
            policy_steps: how many steps the policy drove in all of them.
        """
        steps = tuple(length for episode in turns for length in episode if length)
        # A block may begin at the start of an episode, and after each of the policy's steps.
        chances = policy_steps + len(turns)
        return cls(min(1.0, len(steps) / chances), steps) if steps else cls()


class RandomBlocks:
    """The expert acts in blocks that begin at random, each as long as one that is drawn.

    Between two blocks the policy drives at least one step: else they would be one takeover.
    """

    def __init__(self, config: BlocksConfig) -> None:
        """Store how often blocks come, and how long they are."""
        self.config = config
        self._rng = np.random.default_rng(0)
        self._forget()

    def reset(self, rng: np.random.Generator) -> None:
        """Draw from `rng` from now on, and begin an episode."""
        self._rng = rng
        self._forget()

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """Decide by one draw a step; the expert in any case where there is no proposal."""
        del observation
        # Drawn first, so that an invalid proposal does not shift the draws that follow.
        drawn, which = self._rng.random(2)
        if self._may_begin and drawn < self.config.rate:
            self._left = self.config.steps[int(which * len(self.config.steps))]
        blocked = self._left > 0
        self._left -= blocked
        self._may_begin = not blocked
        if proposal is None:
            return GateDecision(Actor.EXPERT, True, Reason.INVALID_PROPOSAL)
        return GateDecision(Actor.EXPERT if blocked else Actor.POLICY, blocked, Reason.DRAWN)

    def _forget(self) -> None:
        self._left = 0
        self._may_begin = True
