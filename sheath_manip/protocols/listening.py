"""What follows a run without the loop knowing what it is."""

from collections.abc import Callable
from typing import Protocol

from sheath_manip.protocols.environment import Environment
from sheath_manip.types import Episode, EpisodeInfo, Step
from sheath_manip.types.samples import Samples

Report = Callable[[str], None]
"""called once for each unit of work done, with a word on what it was"""


class Listener(Protocol):
    """Follows a run without the loop knowing what it is: recorder, dashboard, progress bar."""

    def on_fit(self, states: Samples) -> None:
        """Called once policy and support have been fitted to `states`."""
        ...

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Called after the environment's reset."""
        ...

    def on_step(self, environment: Environment, step: Step) -> None:
        """Called after each step; may block, for instance while a person holds the run paused."""
        ...

    def on_end(self, episode: Episode) -> None:
        """Called once the episode is complete."""
        ...
