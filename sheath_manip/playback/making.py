"""Recorded episodes as films: looked at again in an environment of their own scene."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.compatibility import Alike, RecordedSpec, require_compatible
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.reader import EpisodeSummary
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.playback.clip import clip
from sheath_manip.playback.film import Film, film_of
from sheath_manip.playback.frames import Pictures, frames, seen
from sheath_manip.playback.page import html
from sheath_manip.playback.video import mp4
from sheath_manip.protocols import Environment, Viewable, require_restorable
from sheath_manip.task import Task
from sheath_manip.types import Episode, TaskSpec

KINDS = ("mp4", "html")


class FilmMaker:
    """Owns the environment: all calls come from the thread that made it.

    Its episodes must fit the first that is asked for, since one page shows them all.
    """

    def __init__(
        self,
        task: Task,
        variant: str | None,
        read: Callable[[int], Episode],
        summary: Callable[[int], EpisodeSummary],
    ) -> None:
        """Store what films are made of.

        Args:
            task: of the episodes.
            variant: of those that do not say in which they were recorded; None is the default.
            read: the episode at a place.
            summary: what is known of it without its arrays.
        """
        self._task = task
        self._variant = variant
        self._read = read
        self._summary = summary
        self._alike = Alike("replay it by itself, with --episode")
        self._scene: tuple[str, int] | None = None
        self._environment: Environment | None = None

    def spec(self, place: int) -> TaskSpec:
        """Return that of the episode at `place`, whose environment is made; raises StoreError."""
        return self._opened(self._summary(place)).spec

    def film(self, place: int) -> Film:
        """The episode at `place`, in its own variant; raises StoreError where it does not fit."""
        summary = self._summary(place)
        environment, info, variant = self._opened(summary), summary.info, self._variant_of(summary)
        episode = self._read(place)
        try:
            return film_of(environment, episode)
        except (ValueError, IndexError, TypeError) as error:
            raise StoreError(
                f"{episode_name(info)} does not fit variant {variant!r} of {info.task} "
                f"({error}); give the --variant that it was recorded in"
            ) from error

    def exported(self, place: int, kind: str) -> tuple[str, bytes]:
        """A file of the episode at `place`, `mp4` or `html`: its name and its content."""
        film = self.film(place)
        return exported(film, self._pictures(film), kind)

    def clip(self, place: int, first: int, stop: int, kind: str) -> tuple[str, bytes]:
        """A file of some steps of the episode at `place`, as `playback.clip` makes it."""
        film = self.film(place)
        return clip(film, self._pictures(film), first, stop, kind)

    def close(self) -> None:
        """Free the simulator."""
        if self._environment is not None:
            self._environment.close()

    def _pictures(self, film: Film) -> Pictures | None:
        return None if self._environment is None else drawn(self._task, self._environment, film)

    def _variant_of(self, summary: EpisodeSummary) -> str:
        return summary.info.variant or self._variant or "default"

    def _opened(self, summary: EpisodeSummary) -> Environment:
        """The environment that an episode was recorded in, made anew where it is another one."""
        info = summary.info
        if info.task != self._task.name:
            raise StoreError(
                f"the episode is of task {info.task!r}; wanted {self._task.name!r}, as the first"
            )
        variant = self._variant_of(summary)
        # Each training run may have a scene of its own.
        scene = variant, info.run_seed if variant in self._task.run_variants else 0
        if self._environment is None or scene != self._scene:
            made = self._task.make_for_run(*scene)
            self.close()
            self._environment, self._scene = made, scene
        require_compatible(
            RecordedSpec.of_task(self._environment.spec),
            summary.spec,
            summary.name,
            f"variant {variant!r} of {info.task}",
            "give the --variant that it was recorded in, or replay it with the version of the task "
            "that recorded it",
        )
        # A page is laid out for the first.
        self._alike.take(summary.name, summary.spec)
        return self._environment


def drawn(task: Task, environment: Environment, film: Film) -> Pictures | None:
    """Return pictures as `task` draws them in an `environment` of the film's scene.

    None where the task draws none, and where the film's moments cannot be returned to.
    """
    picture = task.picture
    if picture is None or not film.state(0).size:
        return None
    # To look at a pose is less work than to observe.
    take = environment.pose_at if isinstance(environment, Viewable) else None
    if take is None:
        take = require_restorable(environment, "pictures of recorded steps").restore

    def of_moment(moment: int) -> NDArray[np.uint8]:
        take(film.state(moment))
        return picture(environment)

    return of_moment


def contact_sheet(task: Task, episode: Episode, moments: Sequence[int]) -> NDArray[np.uint8]:
    """(h, w, 3) RGB: the frames of an episode's film at `moments`, side by side.

    Moments are 0 .. T of an episode of T steps; from the end they count from -1. Raises
    ParameterError where neither the task nor a camera has a picture.
    """
    info = episode.info
    environment = task.make_for_run(info.variant or "default", info.run_seed)
    try:
        film = film_of(environment, episode)
        pictures = drawn(task, environment, film) or seen(film)
        chosen = [range(len(film) + 1)[each] for each in moments]
        shown = frames(film.trace.so_far(), film.outcome, pictures, moments=chosen)
        return np.concatenate(list(shown), axis=1)
    finally:
        environment.close()


def exported(film: Film, pictures: Pictures | None, kind: str) -> tuple[str, bytes]:
    """A file of `film`, `mp4` or `html`: its name and its content.

    Without `pictures` it shows what the cameras saw. Raises ParameterError for another kind, and
    where there was no camera either.
    """
    if kind not in KINDS:
        raise ParameterError(f"an export of kind {kind!r}; wanted {' or '.join(KINDS)}")
    trace = film.trace.so_far()
    shown = frames(trace, film.outcome, seen(film) if pictures is None else pictures)
    video = mp4(shown, film.info.control_rate_hz)
    content = video if kind == "mp4" else html(film, video).encode()
    return f"{episode_name(film.info)}.{kind}", content
