"""Ctrl-C, whatever the code that it falls into makes of it."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import NoReturn


@dataclass
class Interruption:
    """Whether somebody asked this process to end."""

    came: bool = False


@contextmanager
def interruptible() -> Iterator[Interruption]:
    """Raise KeyboardInterrupt at Ctrl-C, as usual, and remember that it came.

    A call into C that is interrupted while it converts its arguments tells of an error of its own
    instead. Where another handler is set, or outside the main thread, nothing is changed.
    """
    interruption = Interruption()

    def interrupt(number: int, frame: FrameType | None) -> NoReturn:  # noqa: ARG001
        interruption.came = True
        raise KeyboardInterrupt

    ours = threading.current_thread() is threading.main_thread()
    ours = ours and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if ours:
        signal.signal(signal.SIGINT, interrupt)
    try:
        yield interruption
    finally:
        if ours:
            signal.signal(signal.SIGINT, signal.default_int_handler)
