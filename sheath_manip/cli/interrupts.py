"""Ctrl-C, whatever the code that it falls into makes of it."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType


@dataclass
class Interruption:
    """Whether somebody asked this process to end."""

    came: bool = False


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Do at Ctrl-C what is done anyway, such as to raise KeyboardInterrupt; note that it came.

    A call into C that is interrupted while it converts its arguments tells of an error of its own
    instead. Where nothing is done at Ctrl-C, or outside the main thread, nothing is changed.
    """
    interruption = Interruption()
    before = signal.getsignal(signal.SIGINT)
    if not callable(before) or threading.current_thread() is not threading.main_thread():
        yield interruption
        return

    def interrupt(number: int, frame: FrameType | None) -> None:
        interruption.came = True
        before(number, frame)

    signal.signal(signal.SIGINT, interrupt)
    try:
        yield interruption
    finally:
        signal.signal(signal.SIGINT, before)
