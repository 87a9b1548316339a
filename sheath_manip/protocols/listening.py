"""What follows a run without the loop knowing what it is."""

from collections.abc import Callable
from typing import ClassVar, Protocol, runtime_checkable

from sheath_manip.protocols.environment import Environment
from sheath_manip.types import Episode, EpisodeInfo, Step
from sheath_manip.types.samples import Samples
from sheath_manip.types.work import Headway, Work

Report = Callable[[str], None]
"""called once for each unit of work done, with a word on what it was"""


class Listener(Protocol):
    """Follows a run without the loop knowing what it is: recorder, dashboard, progress bar.

    One that raises is left out for the rest of the episode, and the run goes on.
    """

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


@runtime_checkable
class DropsOut(Protocol):
    """A listener that must know that it has failed: what it shows stands still from then on."""

    def on_dropped(self) -> None:
        """Called once it is left out for the rest of the episode."""
        ...


@runtime_checkable
class WorkListener(Protocol):
    """A listener that wants to know what is done while no episode runs."""

    def on_work(self, work: Work | None) -> None:
        """Called as long work begins, as it goes on, and with None once it is over."""
        ...


@runtime_checkable
class HeadwayListener(Protocol):
    """A listener that wants to know how far the whole run is."""

    def on_headway(self, headway: Headway) -> None:
        """Called after each unit of it."""
        ...


@runtime_checkable
class Keeps(Listener, Protocol):
    """A listener without which the run is for nothing, such as a recorder: where it fails, it ends.

    An episode that was cut short is told of by `on_end` too, its outcome being an error.
    """

    keeps: ClassVar[bool]
