"""Listeners that let an episode begin only when a person is there."""

from collections.abc import Collection

from sheath_manip.cockpit.cockpit import Cockpit
from sheath_manip.cockpit.unattended import require_attended
from sheath_manip.protocols import Environment
from sheath_manip.types import Actor, Episode, EpisodeInfo, Purpose, Step
from sheath_manip.types.samples import Samples


class UntilTaken:
    """Holds each episode before its first step, and asks; who drives on need not be asked."""

    def __init__(self, cockpit: Cockpit) -> None:
        self.cockpit = cockpit

    def on_fit(self, states: Samples) -> None:
        """Do nothing: a fit has nothing to wait for."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Wait for the person; not for one who will never come, since the page is gone."""
        del environment, info
        while not (self.cockpit.now().taken or self.cockpit.closed):
            self.cockpit.give_turn(Actor.HOLD, asking=True, left_s=float("inf"))
            self.cockpit.rest()

    def on_step(self, environment: Environment, step: Step) -> None:
        """Do nothing: a step has nothing to wait for."""

    def on_end(self, episode: Episode) -> None:
        """Do nothing: an end has nothing to wait for."""


class UntilReady:
    """Holds a run before the first step of all, until a person takes over or lets it begin."""

    def __init__(
        self, cockpit: Cockpit, purposes: Collection[Purpose] = frozenset(Purpose)
    ) -> None:
        """Hold it before the first episode of one of those `purposes`; others need no person."""
        self.cockpit = cockpit
        self.purposes = frozenset(purposes)
        self._ready = False

    def on_fit(self, states: Samples) -> None:
        """Do nothing: a fit has nothing to wait for."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Wait, the first time; raises UnattendedError where the page goes meanwhile."""
        del environment
        if self._ready or info.purpose not in self.purposes:
            return
        self.cockpit.await_ready()
        if (now := self.cockpit.now()).abandoned:
            require_attended(now)
        self._ready = True

    def on_step(self, environment: Environment, step: Step) -> None:
        """Do nothing: a step has nothing to wait for."""

    def on_end(self, episode: Episode) -> None:
        """Do nothing: an end has nothing to wait for."""
