"""One operator at a time: the right to drive, kept by a heartbeat."""

import threading
from collections.abc import Callable

LOST_AFTER_S = 0.4
"""without a heartbeat the operator's input counts as empty; with a control period of .1 s on top
the robot holds within half a second"""
FREE_AFTER_S = 3.0
"""without a heartbeat another one may take over: a page that reloads gets its own turn back"""


class Lease:
    """Who drives. Its methods may be called from any thread."""

    def __init__(self, clock: Callable[[], float]) -> None:
        """`clock` gives seconds that never go back."""
        self._clock = clock
        self._lock = threading.Lock()
        self._holder: str | None = None
        self._beat_s = 0.0

    @property
    def holder(self) -> str | None:
        """The station that drives, None where nobody does."""
        with self._lock:
            return self._current()

    @property
    def alive(self) -> bool:
        """Whether somebody drives and was heard of a moment ago."""
        with self._lock:
            return self._current() is not None and self._silence_s() <= LOST_AFTER_S

    def take(self, station: str) -> bool:
        """Give it to `station` where nobody else has it; whether it has it now."""
        with self._lock:
            if self._current() not in (None, station):
                return False
            self._holder, self._beat_s = station, self._clock()
            return True

    def beat(self, station: str) -> bool:
        """A sign of life; whether `station` has the lease."""
        with self._lock:
            if self._current() != station:
                return False
            self._beat_s = self._clock()
            return True

    def release(self, station: str) -> None:
        """Give it up, where `station` has it."""
        with self._lock:
            if self._holder == station:
                self._holder = None

    def _current(self) -> str | None:
        if self._holder is not None and self._silence_s() > FREE_AFTER_S:
            self._holder = None
        return self._holder

    def _silence_s(self) -> float:
        return self._clock() - self._beat_s
