"""Ctrl-C is for the process that was called, which ends those that it started."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def deaf_children() -> Iterator[None]:
    """Start processes that do not hear the SIGINT which a terminal sends to all of its own.

    Each would print a traceback of its own. They inherit what this thread blocks; a SIGINT of this
    process is heard by another thread, or afterwards.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
