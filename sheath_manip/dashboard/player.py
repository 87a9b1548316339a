"""Plays recorded episodes: which one, where in it, how fast. One thread owns the environment."""

import queue
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from sheath_manip.exceptions import SheathError
from sheath_manip.playback.film import Film

SLOWEST, FASTEST = 0.1, 8.0
"""times the episode's own pace"""
IDLE_S = 0.2


@dataclass(frozen=True, eq=False)
class Played:
    """What is on, at one moment."""

    place: int = 0
    """of the episode, in the catalog"""
    film: Film | None = None
    """None until the first one has been read"""
    at: int = 0
    playing: bool = True
    backwards: bool = False
    speed: float = 1.0
    note: str = ""
    """what is being done, or what went wrong; for a person"""


class Player:
    """Callbacks ask from any thread; `run` does it on the thread that made the environment."""

    def __init__(
        self,
        film_at: Callable[[int], Film],
        wake: Callable[[], None],
        speed: float = 1.0,
        again: bool = True,
    ) -> None:
        """Play nothing yet.

        Args:
            film_at: reads the episode at a place.
            wake: called after each change.
            speed: times the episode's own pace.
            again: begin anew at the end, else `run` returns there.
        """
        self._film_at = film_at
        self._wake = wake
        self._again = again
        self._asked: queue.SimpleQueue[Callable[[], None]] = queue.SimpleQueue()
        self._closing = threading.Event()
        self._now = Played(speed=speed)

    @property
    def now(self) -> Played:
        """What is on."""
        return self._now

    def load(self, place: int, step: int | None = None) -> None:
        """Put on the episode at `place`, from its beginning; or stand at that `step`, clamped."""
        self.do(lambda: self._load(place, step), "reading the episode …")

    def look_at(self, step: int) -> None:
        """Go to that step, clamped, and stay there."""
        self._asked.put(lambda: self._set(at=self._clamped(step), playing=False))

    def nudge(self, steps: int) -> None:
        """Go on or back by so many steps, and stay there."""
        self._asked.put(lambda: self._set(at=self._clamped(self._now.at + steps), playing=False))

    def toggle(self) -> None:
        """Play or stand still; at the end, play from the beginning."""
        self._asked.put(self._toggle)

    def shuttle(self, backwards: bool) -> None:
        """Play that way, and twice as fast each time that it is asked for again."""
        self._asked.put(lambda: self._shuttle(backwards))

    def stop(self) -> None:
        """Stand still."""
        self._asked.put(lambda: self._set(playing=False))

    def pace(self, speed: float) -> None:
        """Play so many times as fast, clamped."""
        self._asked.put(lambda: self._set(speed=min(max(speed, SLOWEST), FASTEST)))

    def do(self, work: Callable[[], None], note: str) -> None:
        """Have something done that needs the environment; `note` says so meanwhile."""

        def noted() -> None:
            self._set(note=note)
            work()

        self._asked.put(noted)

    def say(self, note: str) -> None:
        """Tell the person something; on the player's own thread."""
        self._set(note=note)

    def run(self) -> None:
        """Play until `close`; errors of what was asked for are told and end nothing."""
        due_s = time.monotonic()
        while not self._closing.is_set():
            now = self._now
            moving = now.playing and now.film is not None
            wait_s = max(0.0, due_s - time.monotonic()) if moving else IDLE_S
            if self._followed(wait_s):
                continue
            if not moving:
                due_s = time.monotonic()
                continue
            if not self._advance():
                return
            assert now.film is not None
            # What reading or a slow machine took is not caught up.
            step_s = 1 / (now.film.info.control_rate_hz * self._now.speed)
            due_s = max(due_s + step_s, time.monotonic())

    def close(self) -> None:
        """End `run` soon."""
        self._closing.set()
        self._asked.put(lambda: None)

    def _followed(self, wait_s: float) -> bool:
        """Wait for something that is asked for, and do it; whether anything was."""
        try:
            asked = self._asked.get(timeout=max(wait_s, 1e-4))
        except queue.Empty:
            return False
        try:
            asked()
        except SheathError as error:
            self._set(note=str(error))
        return True

    def _advance(self) -> bool:
        """One step on; whether there is anything left to play."""
        film = self._now.film
        assert film is not None
        if self._now.backwards:
            at = max(self._now.at - 1, 0)
            self._set(at=at, playing=at > 0)
            return True
        if self._now.at + 1 < len(film):
            self._set(at=self._now.at + 1)
            return True
        if self._again:
            self._set(at=0)
        return self._again

    def _load(self, place: int, step: int | None) -> None:
        film = self._now.film
        # To look at another moment of the same one takes no reading.
        if film is None or step is None or place != self._now.place:
            film = self._film_at(place)
        at = 0 if step is None else min(max(step, 0), max(len(film) - 1, 0))
        playing = step is None
        self._set(place=place, film=film, at=at, playing=playing, backwards=False, note=film.lacks)

    def _toggle(self) -> None:
        now, film = self._now, self._now.film
        at_end = film is not None and now.at + 1 >= len(film)
        at = 0 if at_end and not now.playing else now.at
        self._set(playing=not now.playing, at=at, backwards=False)

    def _shuttle(self, backwards: bool) -> None:
        now = self._now
        again = now.playing and now.backwards is backwards
        speed = min(2 * now.speed, FASTEST) if again else 1.0
        self._set(playing=True, backwards=backwards, speed=speed)

    def _clamped(self, step: int) -> int:
        length = 0 if self._now.film is None else len(self._now.film)
        return min(max(step, 0), max(length - 1, 0))

    def _set(self, **what: object) -> None:
        self._now = replace(self._now, **what)  # pyright: ignore[reportArgumentType]
        self._wake()
