"""Waiting for what another thread or process does."""

import time
from collections.abc import Callable

DEADLINE_S = 60.0
"""Far more than anything takes on a busy machine: it costs time only where a test fails."""


def eventually(condition: Callable[[], bool], timeout_s: float = DEADLINE_S) -> bool:
    """Whether `condition` came true in time; let it say all that is asserted next."""
    deadline_s = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > deadline_s:
            return False
        time.sleep(0.01)
    return True
