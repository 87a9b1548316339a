"""An episode that a person discards leaves nothing, and its scene is run again."""

from collections.abc import Callable
from typing import Protocol

import numpy as np

from sheath_manip.exceptions import SheathError
from sheath_manip.seeding import generator
from sheath_manip.types import Episode, EpisodeInfo


class DiscardedError(SheathError):
    """Ends a rollout whose episode nobody wants; a recorder writes only whole ones."""


class Attempt(Protocol):
    """A rollout of which only the randomness is left open."""

    def __call__(self, *, rng: np.random.Generator) -> Episode:
        """Run it."""
        ...


def until_kept(attempt: Attempt, info: EpisodeInfo, report: Callable[[str], None]) -> Episode:
    """The first episode of `attempt` that is not discarded, each begun with the draws of `info`.

    `report` is told of the others.
    """
    while True:
        rng = generator("gate", info.method, info.run_seed, info.round, info.index)
        try:
            return attempt(rng=rng)
        except DiscardedError:
            report("discarded")
