"""All who follow a run: a page that fails is left out, a recorder that fails ends the run."""

import logging
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from sheath_manip.exceptions import AttemptError, SheathError
from sheath_manip.protocols import DropsOut, Environment, Keeps, Listener
from sheath_manip.rollout.guard import BrokenError, ask, name_of
from sheath_manip.rollout.watch import waiting_on_purpose
from sheath_manip.types import Episode, EpisodeInfo, Step
from sheath_manip.types.samples import Samples

logger = logging.getLogger(__name__)

RECORDER = "recorder"


class Audience:
    """Tells listeners in their order, each until it fails."""

    def __init__(self, listeners: Sequence[Listener]) -> None:
        # Told once: a protocol is slow to look for at each step.
        self._listeners = [_Member.of(one) for one in listeners]

    @property
    def keeps(self) -> bool:
        """Whether a recorder is among them."""
        return any(each.keeps for each in self._listeners)

    def fit(self, states: Samples) -> None:
        """Policy and support have been fitted."""
        self.tell(lambda listener: listener.on_fit(states))

    def start(self, environment: Environment, info: EpisodeInfo) -> None:
        """An episode begins."""
        self.tell(lambda listener: listener.on_start(environment, info))

    def step(self, environment: Environment, step: Step) -> None:
        """A step was made."""
        self.tell(lambda listener: listener.on_step(environment, step))

    def end(self, episode: Episode) -> None:
        """An episode is complete; all are told, then what a recorder raised is raised."""
        failures: list[BrokenError] = []
        for each in list(self._listeners):
            try:
                self._tell_one(each, _recorded if each.keeps else _ended, episode)
            except BrokenError as error:
                failures.append(error)
        for error in failures:
            # Raised on purpose, such as a StoreError, it is a line of its own.
            if isinstance(error.__cause__, SheathError | OSError):
                raise error.__cause__
            raise AttemptError(f"{error}; the episode is not recorded") from error

    def tell(self, call: Callable[[Any], None]) -> None:
        """Make one call of each."""
        for each in list(self._listeners):
            self._tell_one(each, call)

    def _tell_one(self, each: "_Member", call: Callable[..., None], *arguments: object) -> None:
        try:
            ask(each.who, call, each.listener, *arguments)
        except BrokenError as error:
            if each.keeps:
                raise
            self._listeners.remove(each)
            logger.warning("%s; the run goes on without it", error)
            if isinstance(each.listener, DropsOut):
                with suppress(BrokenError):
                    ask(each.who, each.listener.on_dropped)


@dataclass(frozen=True, eq=False)
class _Member:
    listener: Listener
    keeps: bool
    who: str

    @classmethod
    def of(cls, listener: Listener) -> "_Member":
        keeps = isinstance(listener, Keeps)
        return cls(listener, keeps, RECORDER if keeps else f"listener {name_of(listener)}")


def _ended(listener: Listener, episode: Episode) -> None:
    listener.on_end(episode)


def _recorded(listener: Listener, episode: Episode) -> None:
    # To write takes as long as it takes, and is never broken off.
    with waiting_on_purpose():
        listener.on_end(episode)
