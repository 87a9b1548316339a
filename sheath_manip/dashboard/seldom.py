"""How often a moving page shows what is dear to encode."""

import math
import time

from sheath_manip.dashboard.moment import Moment

JUMP_STEPS = 3
"""farther than that a moving page does not get between two drawings"""


class Seldom:
    """Lets through so many moments a second; where the page stands still or jumps, every one."""

    def __init__(self, rate_hz: float) -> None:
        self._period_s = 1 / rate_hz
        self._last_s = -math.inf
        self._at = -1
        self._skipped = False

    def due(self, moment: Moment) -> bool:
        """Return whether to draw this time."""
        now_s = time.monotonic()
        stands = moment.paused or moment.outcome is not None
        jumped = abs(moment.at - self._at) > JUMP_STEPS
        # Drawn again it does not move on, such as while a car waits for its person.
        missed = self._skipped and moment.at == self._at
        self._at = moment.at
        due = stands or jumped or missed or now_s - self._last_s >= self._period_s
        if due:
            self._last_s = now_s
        self._skipped = not due
        return due
