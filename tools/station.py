"""A program at the controls: it drives through the page's own websocket, and through nothing else.

with Station(dashboard.address) as station:
    station.order("take-over")
    station.hold(keys=["KeyI"])
"""

import http.client
import json
import threading
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from http.cookies import SimpleCookie
from typing import Any
from urllib.parse import urlsplit

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from sheath_manip.dashboard.operator_socket import PATH
from sheath_manip.protocols.closing import Closes

BEAT_S = 0.1
TIMEOUT_S = 60.0


@dataclass(frozen=True)
class Admission:
    """What a browser gets that opens a page's printed address."""

    cookie: str
    """as a Cookie header says it"""
    path: str
    """below which the page lies"""


def admission(address: str) -> Admission:
    """Open the printed `address` as a browser does; empty where that lets nobody in."""
    where = urlsplit(address)
    connection = http.client.HTTPConnection(str(where.hostname), where.port, timeout=TIMEOUT_S)
    try:
        connection.request("GET", f"{where.path}?{where.query}")
        cookies = SimpleCookie(connection.getresponse().getheader("Set-Cookie") or "")
    finally:
        connection.close()
    for each in cookies.values():
        return Admission(f"{each.key}={each.value}", each["path"])
    return Admission("", "")


def open_socket(address: str, path: str = PATH, **options: Any) -> ClientConnection:
    """A websocket at `path` below the page's, with the cookie.

    `options` are those of `websockets.sync.client.connect`.
    """
    admitted = admission(address)
    return connect(
        f"ws://{urlsplit(address).netloc}{admitted.path}{path}",
        additional_headers={"Cookie": admitted.cookie},
        proxy=None,
        open_timeout=TIMEOUT_S,
        **options,
    )


class Station(Closes):
    """Holds keys and a gamepad, beats, and knows what the server shows it."""

    def __init__(self, address: str, beat_s: float = BEAT_S) -> None:
        """Connect to the page of that printed `address`."""
        self._socket = open_socket(address)
        self._beat_s = beat_s
        self._lock = threading.Lock()
        self._held: dict[str, Any] = {"keys": []}
        self._closing = threading.Event()
        self.shown: dict[str, Any] = {}
        """the last state that the server told"""
        self._threads = [
            threading.Thread(target=each, name=f"station {each.__name__}", daemon=True)
            for each in (self._listen, self._beat)
        ]
        for thread in self._threads:
            thread.start()

    def order(self, order: str, value: float = 1.0) -> None:
        """Give an order, by its name on the wire; it goes by what was last `shown`."""
        now = self.shown
        shown = {"seen": now.get("stops"), "robot": now.get("robot") or None}
        shown["episode"] = now.get("episode")
        self.send({"order": order, "value": value, **shown})

    def hold(
        self,
        keys: Iterable[str] = (),
        axes: Iterable[float] | None = None,
        buttons: Iterable[int] = (),
    ) -> None:
        """Hold these, and nothing else, from now on; no gamepad where `axes` is None."""
        held: dict[str, Any] = {"keys": sorted(keys)}
        if axes is not None:
            held["pad"] = {"axes": [float(axis) for axis in axes], "buttons": sorted(buttons)}
        with self._lock:
            self._held = held
        self._say_held()

    def send(self, message: dict[str, Any]) -> None:
        """Send what may be no message at all."""
        self._socket.send(json.dumps(message))

    def until(self, condition: Callable[[dict[str, Any]], bool], timeout_s: float = 60.0) -> None:
        """Wait until `shown` is so; raises TimeoutError."""
        deadline_s = time.monotonic() + timeout_s
        while not condition(self.shown):
            if time.monotonic() > deadline_s:
                raise TimeoutError(f"the page shows {self.shown}")
            time.sleep(0.01)

    def vanish(self) -> None:
        """Go silent without a word, as a machine does that has crashed."""
        self._closing.set()

    def close(self) -> None:
        """Leave."""
        self._closing.set()
        self._socket.close()
        for thread in self._threads:
            thread.join(TIMEOUT_S)

    def _listen(self) -> None:
        try:
            for raw in self._socket:
                self.shown = json.loads(raw)
        except ConnectionClosed:
            pass

    def _beat(self) -> None:
        try:
            while not self._closing.wait(self._beat_s):
                self._say_held()
        except ConnectionClosed:
            pass

    def _say_held(self) -> None:
        with self._lock:
            # Under the lock, so that what was held before is not said after what is held now.
            self.send({**self._held, "clock": time.monotonic() * 1000})
