"""What measurements of the page share: their sizes, and rollouts that end once enough is seen."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from sheath_manip.protocols import Environment, Expert, Gate, Listener, Policy
from sheath_manip.rollout.loop import NOBODY, rollout
from sheath_manip.types import Actor, EpisodeInfo, Purpose, Step

READERS, STALLED = 2, 1
RATE_HZ = 20.0


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    rounds: int
    """of blocks that take turns, without and with the page"""
    block: int
    """steps in each"""
    frames: int
    """drawn to see what one costs"""
    trials: int
    """of taking over, and of stopping"""
    wall_episodes: int = 0
    """of the replay whose wall is open beside"""


class EnoughError(BaseException):
    """Ends a rollout that has shown what it was run for; what is an Exception, a run survives."""


@dataclass
class Taking:
    """A listener that has another one follow in turns, and notes when each step was done."""

    page: Listener
    block: int
    rounds: int
    done_s: list[float] = field(default_factory=list)

    def on_fit(self, states) -> None:
        """Nothing is measured of it."""

    def on_start(self, environment, info) -> None:
        """The page sees the scene."""
        self.page.on_start(environment, info)

    def on_step(self, environment, step: Step) -> None:
        """The page follows every second block."""
        if len(self.done_s) // self.block % 2:
            self.page.on_step(environment, step)
        self.done_s.append(time.perf_counter())
        if len(self.done_s) >= 2 * self.rounds * self.block:
            raise EnoughError

    def on_end(self, episode) -> None:
        """Nothing is measured of it."""

    def periods_s(self) -> tuple[np.ndarray, np.ndarray]:
        """Between steps, without and with the page; the first of each block is neither's."""
        periods = np.diff(np.array(self.done_s))
        at = np.arange(1, len(self.done_s))
        within, watched = at % self.block != 0, at // self.block % 2 == 1
        return periods[within & ~watched], periods[within & watched]


def run_until_enough(
    environment: Environment,
    gate: Gate,
    listeners: Sequence[Listener],
    *,
    policy: Policy | None = None,
    expert: Expert | None = None,
    others: Mapping[Actor, Expert] = NOBODY,
) -> None:
    """Episode after episode until a listener has seen enough."""
    spec = environment.spec
    try:
        for index in range(1_000_000):
            rollout(
                environment,
                EpisodeInfo(spec.name, index, Purpose.LEARNING, spec.control_rate_hz),
                gate,
                rng=np.random.default_rng(index),
                policy=policy,
                expert=expert,
                others=others,
                listeners=listeners,
            )
    except EnoughError:
        pass
