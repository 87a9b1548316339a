"""A tunnel to a server of this machine, and a slow one, that hands on so much a second.

The slow one takes in all, as a router with a deep buffer does: the sender never notices that it
queues.
"""

import queue
import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

CHUNK = 4096


class Tunnel:
    """Forwards connections from an address of its own, as ssh -L does."""

    def __init__(self, port: int, at: tuple[str, int] = ("127.0.0.1", 0)) -> None:
        """Lead to `port` of this machine, at full speed until `bytes_per_s` is set."""
        self.bytes_per_s = float("inf")
        self._inner = port
        family = socket.AF_INET6 if ":" in at[0] else socket.AF_INET
        self._listener = socket.create_server(at, family=family)
        self.port: int = self._listener.getsockname()[1]
        self._lock = threading.Lock()
        self._free_s = 0.0
        self._sockets: list[socket.socket] = []
        threading.Thread(target=self._accept, daemon=True).start()

    @property
    def used(self) -> bool:
        """Whether anybody came through."""
        return bool(self._sockets)

    def close(self) -> None:
        """Cut everything."""
        # Without it the port is taken for as long as a thread waits there for visitors.
        self._listener.shutdown(socket.SHUT_RDWR)
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
        with suppress(OSError):
            while chunk := outer.recv(1 << 16):
                inner.sendall(self._said(chunk))
            inner.shutdown(socket.SHUT_WR)

    def _said(self, chunk: bytes) -> bytes:
        return chunk

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


class SlowLink(Tunnel):
    """A tunnel of another port, of which the server knows nothing."""

    def address(self, printed: str) -> str:
        """The address that leads through here, of the one that the server printed."""
        return printed.replace(f":{self._inner}/", f":{self.port}/")

    def _said(self, chunk: bytes) -> bytes:
        # The server answers to its own port alone; both have five digits.
        mine, its = f"127.0.0.1:{self.port}".encode(), f"127.0.0.1:{self._inner}".encode()
        return chunk.replace(mine, its)


@contextmanager
def slow_link(port: int) -> Iterator[SlowLink]:
    """A link to `port`, until the block ends."""
    link = SlowLink(port)
    try:
        yield link
    finally:
        link.close()
