"""How long those may take who decide a control step, and what breaks off a call that hangs."""

import ctypes
import logging
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass

from sheath_manip.exceptions import ParameterError

logger = logging.getLogger(__name__)

PATIENCE = 30.0
"""A reset builds a scene, and a network's first look may compile it."""
LOOKS = 10
"""that the watchdog takes in the time after which a call hangs"""


@dataclass(frozen=True)
class Deadline:
    """The time that policy, gate and whose turn it is have in a control step."""

    share: float = 1.0
    """of the control period, for all of them together; what comes later is late"""
    hang_s: float = 2.0
    """after which a call to anything that does not return is broken off; `PATIENCE` times as
    long where the robot rests: before and in an episode's first step, and after its last one"""

    def __post_init__(self) -> None:
        for name in ("share", "hang_s"):
            value = getattr(self, name)
            if not value > 0:
                raise ParameterError(f"{name} of the deadline is {value}; wanted more than 0")


class HungError(BaseException):
    """Breaks off a call that hangs; no `except Exception` on its way stops it."""


class Watch:
    """Measures a step's answers, and breaks off calls that hang, on a thread of its own.

    A call is broken off wherever it is in Python, and on the main thread also where it sleeps or
    waits for a lock or a socket. Native code that never returns cannot be broken off: then there is
    only `on_hang`, which is called first in any case.
    """

    def __init__(
        self,
        deadline: Deadline,
        control_rate_hz: float,
        on_hang: Callable[[], None],
        clock: Callable[[], float] = time.perf_counter,
    ) -> None:
        """Begin to watch the thread that calls this.

        Args:
            deadline: of a step.
            control_rate_hz: of the task, times the speed of the run.
            on_hang: brings the robot to rest, where that can be done from another thread.
            clock: seconds that never go back.
        """
        self.hang_s = PATIENCE * deadline.hang_s
        """of the present calls"""
        self._deadline = deadline
        self._allowed_s = deadline.share / control_rate_hz
        self._on_hang = on_hang
        self._clock = clock
        self._began_s = clock()
        self._excused_s = 0.0
        self._rests = True
        self._since_s: float | None = None
        """when the present call began, or came back from one of its own"""
        self._watched = threading.get_ident()
        # Only there signals are handled, and not every system has this one.
        self._main = threading.current_thread() is threading.main_thread() and hasattr(
            signal, "SIGUSR1"
        )
        self._over = threading.Event()
        self._before = signal.signal(signal.SIGUSR1, self._break_off) if self._main else None
        self._thread = threading.Thread(target=self._watch, name="watchdog", daemon=True)
        self._thread.start()

    def begin_step(self, rests: bool) -> None:
        """Count the time from now; nobody is late where the robot `rests` still."""
        self._began_s, self._excused_s = self._clock(), 0.0
        self._rests = rests
        self.hang_s = self._deadline.hang_s * (PATIENCE if rests else 1.0)

    def end_steps(self) -> None:
        """Be patient again."""
        self.hang_s = PATIENCE * self._deadline.hang_s

    @property
    def late(self) -> bool:
        """Whether the step's answers took longer than they may."""
        spent_s = self._clock() - self._began_s - self._excused_s
        return not self._rests and spent_s > self._allowed_s

    @contextmanager
    def called(self) -> Iterator[None]:
        """Watch a call."""
        outer, self._since_s = self._since_s, self._clock()
        try:
            yield
        finally:
            self._since_s = None if outer is None else self._clock()

    @contextmanager
    def excused(self) -> Iterator[None]:
        """Take no notice of the time: it is waited on purpose."""
        outer, self._since_s = self._since_s, None
        began_s = self._clock()
        try:
            yield
        finally:
            now_s = self._clock()
            self._excused_s += now_s - began_s
            self._since_s = None if outer is None else now_s

    def close(self) -> None:
        """Watch no longer."""
        self._over.set()
        self._thread.join()
        if self._main:
            signal.signal(signal.SIGUSR1, self._before)

    def _hangs(self) -> bool:
        since_s = self._since_s
        return since_s is not None and self._clock() - since_s > self.hang_s

    def _watch(self) -> None:
        told: float | None = None
        while not self._over.wait(self._deadline.hang_s / LOOKS):
            since_s = self._since_s
            if not self._hangs():
                continue
            if told != since_s:
                told = since_s
                try:
                    self._on_hang()
                except Exception as error:
                    logger.warning("the robot could not be told to hold (%s)", type(error).__name__)
            if self._main:
                signal.pthread_kill(self._watched, signal.SIGUSR1)
            else:
                ctypes.pythonapi.PyThreadState_SetAsyncExc(
                    ctypes.c_ulong(self._watched), ctypes.py_object(HungError)
                )

    def _break_off(self, *_: object) -> None:
        # The call may have come back meanwhile.
        if self._hangs():
            raise HungError


_WATCH: ContextVar[Watch | None] = ContextVar("watch", default=None)


def present_watch() -> Watch | None:
    """Return the watch of the rollout that runs in this thread; None where it has no deadline."""
    return _WATCH.get()


@contextmanager
def watched(watch: Watch | None) -> Iterator[None]:
    """Have `watch` be the present one, and end it."""
    token = _WATCH.set(watch)
    try:
        yield
    finally:
        _WATCH.reset(token)
        if watch is not None:
            watch.close()


@contextmanager
def waiting_on_purpose() -> Iterator[None]:
    """Wait in here for a person, or for the next step to be due: nobody is late for that."""
    watch = _WATCH.get()
    if watch is None:
        yield
    else:
        with watch.excused():
            yield
