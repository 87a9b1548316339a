"""Discard an episode on the operator's request and run the same scene again."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from sheath_manip.exceptions import SheathError
from sheath_manip.seeding import generator
from sheath_manip.types import Episode, EpisodeInfo, Purpose


class DiscardedError(SheathError):
    """Ends a rollout whose episode nobody wants; a recorder writes only whole ones."""


class Attempt(Protocol):
    """A rollout of which only the randomness is left open."""

    def __call__(self, *, rng: np.random.Generator) -> Episode:
        """Run it."""
        ...


def draws_of(info: EpisodeInfo) -> np.random.Generator:
    """Return what all draws of an episode come from: on a held-out scene the scene alone."""
    if info.purpose is Purpose.EVALUATION:
        return generator("alone", info.seed)
    return generator("gate", info.method, info.run_seed, info.round, info.index)


def until_kept(attempt: Attempt, info: EpisodeInfo, report: Callable[[str], None]) -> Episode:
    """The first episode of `attempt` that is not discarded, each begun with the draws of `info`.

    `report` is told of the others.
    """
    while True:
        try:
            return attempt(rng=draws_of(info))
        except DiscardedError:
            report("discarded")
