"""viser's stream to one browser: no more under way than it takes, and marks behind the pictures.

viser sends as fast as it draws. Over a slow link that would queue, in the kernel and in proxies,
and the person at its end would drive by what was seconds ago. So each message is followed by a
ping, and the next is made only when the browser has answered: what was to be shown meanwhile is
dropped, since viser keeps only the newest value of everything.
"""

import asyncio
import time
from collections import deque
from collections.abc import Awaitable, Callable
from typing import Any

from sheath_manip.dashboard.picture_age import PictureAge

MOST_UNDER_WAY = 2
"""messages to a browser that it has not answered: one that travels, one that waits behind it"""
MARK_EVERY_S = 0.1


class PacedConnection:
    """A websocket that viser sends on."""

    def __init__(self, connection: Any) -> None:
        self._connection = connection
        self._under_way: deque[Awaitable[float]] = deque()
        self._age: PictureAge | None = None
        self._marked_s = 0.0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)

    def carry_marks(
        self, age: PictureAge, true_s: Callable[[], float | None], send: Callable[[int], None]
    ) -> None:
        """Send marks for `age` from now on.

        `true_s` says up to when all that was taken from viser's buffer is true, None while it holds
        more; `send` puts a mark behind it.
        """
        self._age, self._true_s, self._send_mark = age, true_s, send

    async def send(self, message: bytes) -> None:
        """Send it; return when there is room for another one."""
        await self._connection.send(message)
        self._under_way.append(await self._connection.ping())
        self._mark()
        while len(self._under_way) >= MOST_UNDER_WAY:
            await self._under_way.popleft()

    async def keep_marking(self) -> None:
        """Mark the picture also where nothing new is to be drawn."""
        while True:
            await asyncio.sleep(MARK_EVERY_S)
            self._mark()

    def _mark(self) -> None:
        now_s = time.monotonic()
        if self._age is None or now_s - self._marked_s < MARK_EVERY_S:
            return
        true_s = self._true_s()
        if true_s is not None:
            self._marked_s = now_s
            self._send_mark(self._age.mark(true_s))
