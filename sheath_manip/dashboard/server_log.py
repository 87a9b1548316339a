"""What of the web server's log reaches the terminal: of each kind of failure one line, once.

A stranger's request is none: anybody who reaches the port could fill the terminal, and with words
of its own. So no message, traceback or header of a request is passed on, but for a class's name.
"""

import asyncio
import logging
from typing import Any

from websockets.datastructures import MultipleValuesError
from websockets.exceptions import ConnectionClosed, InvalidHandshake

logger = logging.getLogger(__name__)
_STRANGERS = (InvalidHandshake, MultipleValuesError, ConnectionClosed, OSError, EOFError)
"""what a request fails with that is none, or a connection that breaks"""


class _KindsOnce(logging.Handler):
    """Passes on the class of each failure of the page's own, the first time."""

    def __init__(self) -> None:
        super().__init__()
        self._told: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Take a record of websockets'."""
        if record.exc_info and record.exc_info[0]:
            self.tell(record.exc_info[0])

    def tell(self, failure: type[BaseException]) -> None:
        """Say so of `failure`, once, where it is the page's own."""
        name = failure.__name__
        if not issubclass(failure, _STRANGERS) and name not in self._told:
            self._told.add(name)
            logger.warning("a connection to the page failed (%s); the run goes on", name)


def kinds_only() -> logging.Logger:
    """Return a logger for a web server; it belongs to that one alone."""
    quiet = logging.Logger("the page's server", logging.ERROR)
    quiet.addHandler(_KindsOnce())
    return quiet


def quieten(loop: asyncio.AbstractEventLoop) -> None:
    """Have what fails in `loop` beside any connection told in the same way."""
    kinds = _KindsOnce()

    def told(_: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
        error = context.get("exception")
        if error is not None:
            kinds.tell(type(error))

    loop.call_soon_threadsafe(loop.set_exception_handler, told)
