"""Sends what is put into it from a thread of its own, so that no caller ever waits for a pipe."""

import threading
from multiprocessing.connection import Connection
from multiprocessing.reduction import ForkingPickler
from queue import SimpleQueue
from typing import Any


class Outbox:
    """One end of a connection, for sending; what is put after its end is dropped.

    The other process may be stopped, and its pipe full: an emergency stop to others must not wait
    for that, and neither must a control loop.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self._waiting: SimpleQueue[Any] = SimpleQueue()
        self._thread = threading.Thread(target=self._send, name="outbox", daemon=True)
        self._thread.start()

    def put(self, message: object) -> None:
        """Have it sent after all that was put before; returns at once.

        It must be picklable, and nobody may change it any more.
        """
        self._waiting.put(message)

    def put_checked(self, message: object) -> None:
        """The same of what may not be picklable, which is raised here, in whatever way it is."""
        self._waiting.put(ForkingPickler.dumps(message))

    def close(self) -> None:
        """Send what was put, then end the thread; does not wait for it."""
        self._waiting.put(None)

    def _send(self) -> None:
        try:
            while (message := self._waiting.get()) is not None:
                if isinstance(message, bytes | memoryview):
                    self._connection.send_bytes(message)
                else:
                    self._connection.send(message)
        except (OSError, ValueError):
            # The other one has gone, which the one that listens to it knows.
            pass
