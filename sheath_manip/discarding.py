"""An episode that a person discards leaves nothing, and its scene is run again."""

from collections.abc import Callable

from sheath_manip.exceptions import SheathError
from sheath_manip.types import Episode


class DiscardedError(SheathError):
    """Ends a rollout whose episode nobody wants; a recorder writes only whole ones."""


def until_kept(attempt: Callable[[], Episode], report: Callable[[str], None]) -> Episode:
    """The first episode of `attempt` that is not discarded; `report` is told of the others."""
    while True:
        try:
            return attempt()
        except DiscardedError:
            report("discarded")
