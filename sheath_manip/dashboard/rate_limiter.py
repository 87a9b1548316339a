"""How often a moving page shows what is dear to encode."""

import math
import time

from sheath_manip.dashboard.snapshot import Snapshot

READ_RATE_HZ = 10.0
"""of what is read and not watched: texts and plots"""
JUMP_STEPS = 3
"""farther than that a moving page does not get between two drawings"""


class RateLimiter:
    """Lets through so many snapshots a second; where the page stands still or jumps, every one."""

    def __init__(self, rate_hz: float) -> None:
        self._period_s = 1 / rate_hz
        self._last_s = -math.inf
        self._at = -1
        self._skipped = False

    def should_draw(self, snapshot: Snapshot) -> bool:
        """Return whether to draw this time."""
        now_s = time.monotonic()
        stands = snapshot.paused or snapshot.outcome is not None
        jumped = abs(snapshot.at - self._at) > JUMP_STEPS
        # Drawn again it does not move on, such as while a car waits for its person.
        missed = self._skipped and snapshot.at == self._at
        self._at = snapshot.at
        due = stands or jumped or missed or now_s - self._last_s >= self._period_s
        if due:
            self._last_s = now_s
        self._skipped = not due
        return due
