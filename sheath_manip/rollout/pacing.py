"""A listener that slows a rollout down to the task's own rate, for people to watch."""

import time
from collections.abc import Callable

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Environment
from sheath_manip.rollout.watch import waiting_on_purpose
from sheath_manip.types import Episode, EpisodeInfo, Step
from sheath_manip.types.samples import Samples


class Pacing:
    """Sleeps after each step until the next is due; what ran late is not caught up."""

    def __init__(self, speed: float = 1.0, times: Callable[[], float] = lambda: 1.0) -> None:
        """Store the speed: 1 is the control rate, 2 twice as fast; ParameterError unless > 0.

        `times` is asked at each step by how much a person wants it faster.
        """
        if not speed > 0:
            raise ParameterError(f"speed is {speed}; wanted more than 0, such as 1")
        self.speed = speed
        self._times = times
        self._due_s = 0.0

    def on_fit(self, states: Samples) -> None:
        """A fit takes its time, and nothing of it is kept here."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """The first step is due now."""
        del environment, info
        self._due_s = time.monotonic()

    def on_step(self, environment: Environment, step: Step) -> None:
        """Sleep for what is left of the control period."""
        del step
        now_s = time.monotonic()
        rate_hz = environment.spec.control_rate_hz * self.speed * self._times()
        self._due_s = max(self._due_s + 1 / rate_hz, now_s)
        with waiting_on_purpose():
            time.sleep(self._due_s - now_s)

    def on_end(self, episode: Episode) -> None:
        """Do nothing: an end has nothing to wait for."""
