"""How long the rest of a piece of work takes, told from what it took so far."""

import time
from collections.abc import Callable

from sheath_manip.types.work import Headway

LEAST_SHARE, LEAST_S = 0.03, 2.0
"""of a piece of work that is done, before the rest can be told from it"""
ROUND_S = 10
"""to which seconds are said, since nobody knows them better"""


class HeadwayCount:
    """Counts the units of a run that are done."""

    def __init__(self, units: int, took_s: Callable[[], float] | None = None) -> None:
        """Store how many `units` there are, and what gives the time that they took so far.

        That time is from now on, unless `took_s` knows of earlier sessions of the same run: what
        those did is read in no time, and told nothing of what is still to be done.
        """
        self.units = units
        self._took_s = took_s or _stopwatch()
        self._done = 0

    def count(self) -> Headway:
        """Take note of one more unit; return how far the run is."""
        self._done = min(self._done + 1, self.units)
        share = self._done / max(self.units, 1)
        return Headway(self._done, self.units, time_left_s(self._took_s(), share))


def time_left_s(took_s: float, share: float) -> float | None:
    """Return how long the rest takes at the same pace; None while too little was done to tell."""
    told = share >= LEAST_SHARE and took_s >= LEAST_S
    return took_s * (1 - share) / share if told else None


def left_words(headway: Headway) -> str:
    """Return such as "about 20 min left"; empty where it cannot be told, or where nothing is left.

    Hours are said with their minutes, and seconds by the ten.
    """
    left_s = headway.left_s
    if left_s is None or headway.done >= headway.units:
        return ""
    minutes = round(left_s / 60)
    if left_s < 60:
        return f"about {ROUND_S * max(1, round(left_s / ROUND_S))} s left"
    if minutes < 60:
        return f"about {minutes} min left"
    return f"about {minutes // 60} h {minutes % 60:02d} min left"


def _stopwatch() -> Callable[[], float]:
    began_s = time.monotonic()
    return lambda: time.monotonic() - began_s
