"""The thread that draws, so that the control loop never does."""

import logging
import threading
import time
from collections.abc import Callable

logger = logging.getLogger(__name__)


class Drawer:
    """Calls `draw` on its own thread when woken, at most `rate_hz` times a second.

    An exception in `draw` is logged, once as long as it stays the same, and handed to `on_failure`;
    the next waking draws again.
    """

    def __init__(
        self,
        draw: Callable[[], None],
        on_failure: Callable[[str], None],
        rate_hz: float,
    ) -> None:
        self._draw = draw
        self._on_failure = on_failure
        self._period_s = 1 / rate_hz
        self._news = threading.Event()
        self._closing = threading.Event()
        self._last_failure = ""
        self._asked_s: float | None = None
        self._undrawn_s: float | None = None
        self._thread = threading.Thread(target=self._run, name="dashboard drawer", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """Say that there is something new; returns at once."""
        if self._asked_s is None:
            self._asked_s = time.monotonic()
        self._news.set()

    @property
    def true_s(self) -> float:
        """Up to when the page is true: now, or when the first thing came that is not drawn yet."""
        undrawn = [each for each in (self._undrawn_s, self._asked_s) if each is not None]
        return min(undrawn, default=time.monotonic())

    def close(self, timeout_s: float = 5.0) -> None:
        """End the thread after the drawing under way."""
        self._closing.set()
        self._news.set()
        self._thread.join(timeout_s)

    def _run(self) -> None:
        while True:
            self._news.wait()
            self._news.clear()
            if self._closing.is_set():
                return
            began_s = time.monotonic()
            # What could not be drawn before is still not drawn.
            self._undrawn_s = self._asked_s if self._undrawn_s is None else self._undrawn_s
            self._asked_s = None
            if self._draw_safely():
                self._undrawn_s = None
            self._closing.wait(max(0.0, self._period_s - (time.monotonic() - began_s)))

    def _draw_safely(self) -> bool:
        try:
            self._draw()
            self._last_failure = ""
            return True
        except Exception as error:
            failure = f"{type(error).__name__}: {error}"
            if failure != self._last_failure:
                logger.warning("the dashboard could not draw (%s); the run goes on", failure)
            self._last_failure = failure
            try:
                self._on_failure(failure)
            except Exception:
                logger.debug("nor could it say so on the page", exc_info=True)
            return False
