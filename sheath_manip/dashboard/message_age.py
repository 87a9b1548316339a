"""How old a station's messages are, and whether there are too many of them."""

import math

MOST_PER_S = 2000.0
"""messages of one station; a page's own are 20. What it says beyond that it holds is not heard, so
that the robot holds, until it has calmed down; its orders are"""
_DRIFT = 1e-3
"""by which one of two clocks may be faster; quartz is a tenth of it"""


class MessageAge:
    """Tells the age of each message by the station's own clock.

    The two clocks count from different moments. That difference is taken from the message which
    was fastest on its way, so that an age is what a message took longer than that one.
    """

    def __init__(self) -> None:
        self._ahead_s = math.inf
        self._latest_s = 0.0

    def of(self, sent_ms: float | None, arrived_s: float) -> float:
        """Seconds; 0 for a program that does not say when it sent the message."""
        if sent_ms is None:
            return 0.0
        ahead_s = arrived_s - sent_ms / 1000
        allowed_s = self._ahead_s + _DRIFT * (arrived_s - self._latest_s)
        self._ahead_s, self._latest_s = min(allowed_s, ahead_s), arrived_s
        return ahead_s - self._ahead_s


class Budget:
    """Counts messages in a bucket that leaks at the rate which is allowed.

    Once it is over, a station has to stay below for a moment before it is heard again: a robot that
    holds is safer than one that goes by every other message.
    """

    def __init__(self, most_per_s: float = MOST_PER_S) -> None:
        self._most = most_per_s
        self._level = 0.0
        self._latest_s = 0.0
        self._over = False

    def exceeded(self, arrived_s: float) -> bool:
        """Return whether the message of that snapshot is one too many."""
        leaked = self._most * (arrived_s - self._latest_s)
        self._latest_s = arrived_s
        self._level = min(max(0.0, self._level - leaked) + 1.0, 1.5 * self._most)
        self._over = self._level > self._most * (0.5 if self._over else 1.0)
        return self._over
