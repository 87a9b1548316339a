"""What the page may say of the time between two episodes."""

import time
from collections.abc import Callable
from dataclasses import dataclass

from sheath_manip.learning.headway import time_left_s
from sheath_manip.types.work import Work


@dataclass(frozen=True)
class Pastime:
    """What goes on meanwhile, in whole seconds and hundredths."""

    idle_s: int
    """since the last episode ended, or the work began"""
    work: str = ""
    """what is being done; empty where nobody says"""
    percent: int | None = None
    """of it that is done"""
    left_s: int | None = None
    """that it takes, by what it took so far"""


class Between:
    """Knows since when no episode runs, and what is done instead; a listener's part."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._since_s: float | None = None
        self._work: Work | None = None
        self._work_since_s = 0.0

    def note_episode(self, runs: bool) -> None:
        """Take note of whether an episode runs: between two of them the program does other work."""
        self._since_s = None if runs else self._clock()

    def note_work(self, work: Work | None) -> None:
        """Take note of what is done, and how far it is; None: it is over."""
        before = self._work
        # The share goes back where another part of it begins.
        began = before is None or work is None or _goes_back(before, work)
        if began:
            self._work_since_s = self._clock()
        self._work = work

    @property
    def now(self) -> Pastime | None:
        """What is done instead of an episode; None while one runs, and before the first."""
        work, now_s, since_s = self._work, self._clock(), self._since_s
        if since_s is None and work is None:
            return None
        idle_s = int(now_s - (self._work_since_s if since_s is None else since_s))
        if work is None or work.share is None:
            return Pastime(idle_s, "" if work is None else work.what)
        left_s = time_left_s(now_s - self._work_since_s, work.share)
        whole_s = None if left_s is None else round(left_s)
        return Pastime(idle_s, work.what, int(100 * work.share), whole_s)


def _goes_back(before: Work, work: Work) -> bool:
    return before.what != work.what or (work.share or 0.0) < (before.share or 0.0)
