"""A slow link before a server of this machine: it takes in all, and hands on so much a second.

As a router or a tunnel with a deep buffer does: the sender never notices that it queues.
"""

import queue
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

CHUNK = 4096


class SlowLink:
    """Forwards connections from a port of its own; what comes back is slowed down."""

    def __init__(self, port: int) -> None:
        """Lead to `port` of this machine, at full speed until `bytes_per_s` is set."""
        self.bytes_per_s = float("inf")
        self._inner = port
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._listener.getsockname()[1]
        self._lock = threading.Lock()
        self._free_s = 0.0
        self._sockets: list[socket.socket] = []
        threading.Thread(target=self._accept, daemon=True).start()

    def address(self, printed: str) -> str:
        """The address that leads through here, of the one that the server printed."""
        return printed.replace(f":{self._inner}/", f":{self.port}/")

    def close(self) -> None:
        """Cut everything."""
        self._listener.close()
        for each in self._sockets:
            with suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                outer, _ = self._listener.accept()
                inner = socket.create_connection(("127.0.0.1", self._inner))
                self._sockets += [outer, inner]
                waiting: queue.SimpleQueue[bytes] = queue.SimpleQueue()
                for run, arguments in (
                    (self._out, (outer, inner)),
                    (self._take_in, (inner, waiting)),
                    (self._hand_on, (waiting, outer)),
                ):
                    threading.Thread(target=run, args=arguments, daemon=True).start()

    def _out(self, outer: socket.socket, inner: socket.socket) -> None:
        # The server answers to its own port alone; both have five digits.
        mine, its = f"127.0.0.1:{self.port}".encode(), f"127.0.0.1:{self._inner}".encode()
        with suppress(OSError):
            while chunk := outer.recv(1 << 16):
                inner.sendall(chunk.replace(mine, its))
            inner.shutdown(socket.SHUT_WR)

    def _take_in(self, inner: socket.socket, waiting: "queue.SimpleQueue[bytes]") -> None:
        with suppress(OSError):
            while chunk := inner.recv(CHUNK):
                waiting.put(chunk)
        waiting.put(b"")

    def _hand_on(self, waiting: "queue.SimpleQueue[bytes]", outer: socket.socket) -> None:
        with suppress(OSError):
            while chunk := waiting.get():
                with self._lock:
                    now_s = time.monotonic()
                    self._free_s = max(now_s, self._free_s) + len(chunk) / self.bytes_per_s
                    wait_s = self._free_s - now_s
                time.sleep(wait_s)
                outer.sendall(chunk)
            outer.shutdown(socket.SHUT_WR)


@contextmanager
def slow_link(port: int) -> Iterator[SlowLink]:
    """A link to `port`, until the block ends."""
    link = SlowLink(port)
    try:
        yield link
    finally:
        link.close()
