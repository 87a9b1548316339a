"""How often a moving page shows what is dear to encode."""

import math
import time

from sheath_manip.dashboard.moment import Moment


class Seldom:
    """Lets through so many moments a second; those that a person looks at longer, always."""

    def __init__(self, rate_hz: float) -> None:
        self._period_s = 1 / rate_hz
        self._last_s = -math.inf

    def due(self, moment: Moment) -> bool:
        """Whether to draw this one."""
        now_s = time.monotonic()
        stands = moment.paused or not moment.present or moment.outcome is not None
        due = stands or now_s - self._last_s >= self._period_s
        if due:
            self._last_s = now_s
        return due
