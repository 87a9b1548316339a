"""Which step of which episode a page shows: the present one, or one that a person looks back at."""

import threading
from collections.abc import Callable

from sheath_manip.playback.film import Film


class Playhead:
    """Set by callbacks and by the player, read by the drawer."""

    def __init__(self, wake: Callable[[], None]) -> None:
        """`wake` is called after each change."""
        self._lock = threading.Lock()
        self._wake = wake
        self._film: Film | None = None
        self._held: tuple[Film, int] | None = None

    def load(self, film: Film) -> None:
        """Show `film` from now on, unless a person looks back at another."""
        with self._lock:
            self._film = film
        self._wake()

    def look_at(self, step: int) -> None:
        """Keep the shown episode at that step, clamped to those it has, until `release`."""
        with self._lock:
            film = self._film if self._held is None else self._held[0]
            if film is None or not len(film):
                return
            self._held = film, min(max(step, 0), len(film) - 1)
        self._wake()

    def release(self) -> None:
        """Back to the present."""
        with self._lock:
            held, self._held = self._held, None
        if held is not None:
            self._wake()

    @property
    def shown(self) -> tuple[Film, int, bool] | None:
        """The episode, the step in it (-1 before the first), and whether that is the present."""
        with self._lock:
            if self._held is not None:
                return *self._held, False
            return None if self._film is None else (self._film, len(self._film) - 1, True)
