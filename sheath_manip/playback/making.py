"""Recorded episodes as films: looked at again in an environment of their own scene."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.naming import episode_name
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.playback.film import Film, film_of
from sheath_manip.playback.frames import Pictures, frames, seen
from sheath_manip.playback.page import html
from sheath_manip.playback.video import mp4
from sheath_manip.protocols import Environment
from sheath_manip.task import Task
from sheath_manip.types import Episode, TaskSpec

KINDS = ("mp4", "html")


class FilmMaker:
    """Owns the environment: all calls come from the thread that made it."""

    def __init__(self, task: Task, variant: str, read: Callable[[int], Episode]) -> None:
        """Store what films are made of.

        Args:
            task: of the episodes.
            variant: that they were recorded in; one of a run's own scene is made anew for each.
            read: the episode at a place.
        """
        self._task = task
        self._variant = variant
        self._read = read
        self._run_seed: int | None = None
        self._environment = self._opened(0)

    @property
    def spec(self) -> TaskSpec:
        """Of the task."""
        return self._environment.spec

    def film(self, place: int) -> Film:
        """The episode at `place`; raises StoreError where it is not of this task and variant."""
        episode = self._read(place)
        info = episode.info
        if info.task != self._task.name:
            raise StoreError(
                f"the episode is of task {info.task!r}; wanted {self._task.name!r}, as the first"
            )
        self._environment = self._opened(info.run_seed)
        try:
            return film_of(self._environment, episode)
        except (ValueError, IndexError, TypeError) as error:
            raise StoreError(
                f"{episode_name(info)} does not fit variant {self._variant!r} of {info.task} "
                f"({error}); give the --variant that it was recorded in"
            ) from error

    def exported(self, place: int, kind: str) -> tuple[str, bytes]:
        """A file of the episode at `place`, `mp4` or `html`: its name and its content."""
        film = self.film(place)
        return exported(film, self._pictures(film), kind)

    def close(self) -> None:
        """Free the simulator."""
        self._environment.close()

    def _pictures(self, film: Film) -> Pictures | None:
        environment, picture = self._environment, self._task.picture
        if picture is None:
            return None

        def drawn(step: int) -> NDArray[np.uint8]:
            environment.pose_at(film.steps[step].state)
            return picture(environment)

        return drawn

    def _opened(self, run_seed: int) -> Environment:
        """The environment, made anew where each training run has a scene of its own."""
        own = self._variant in self._task.run_variants
        if self._run_seed is not None and (not own or run_seed == self._run_seed):
            return self._environment
        made = self._task.make_for_run(self._variant, run_seed)
        if self._run_seed is not None:
            self._environment.close()
        self._run_seed = run_seed
        return made


def exported(film: Film, pictures: Pictures | None, kind: str) -> tuple[str, bytes]:
    """A file of `film`, `mp4` or `html`: its name and its content.

    Without `pictures` it shows what the cameras saw. Raises ParameterError for another kind, and
    where there was no camera either.
    """
    if kind not in KINDS:
        raise ParameterError(f"an export of kind {kind!r}; wanted {' or '.join(KINDS)}")
    drawn = frames(film, seen(film) if pictures is None else pictures)
    video = mp4(drawn, film.info.control_rate_hz)
    content = video if kind == "mp4" else html(film, video).encode()
    return f"{episode_name(film.info)}.{kind}", content
