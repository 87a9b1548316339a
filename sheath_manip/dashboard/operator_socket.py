"""The page's own websocket: held keys, gamepad, orders and heartbeat in; what to show out.

Beside viser's, because viser knows no held keys, no gamepad and no heartbeat. The page's script
(`operator.js`) speaks it, and so may any program that has the cookie.
"""

import asyncio
import json
import math
import secrets
from contextlib import suppress
from dataclasses import asdict
from itertools import count
from pathlib import Path
from typing import Annotated

import msgspec
from msgspec import Meta
from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed

from sheath_manip.cockpit import Cockpit, Gamepad, Given, Order
from sheath_manip.cockpit.given import MOST_KEYS
from sheath_manip.cockpit.orders import OF_ANY_RUN

PATH = "/keys"
SHOWN_EVERY_S = 0.1
LEAST_GAP_S = 0.002
"""between two messages of a station: whoever floods is slowed down, and nobody else"""
LONGEST_MESSAGE = 2048
"""bytes; a page's own have a tenth of it"""
SCRIPT = Path(__file__).with_name("operator.js")
HOTKEYS = {
    "Space": Order.STOP,
    "KeyR": Order.RESET,
    "KeyT": Order.TAKE_OVER,
    "KeyH": Order.HAND_BACK,
    "KeyP": Order.PAUSE,
    "Period": Order.STEP,
    "KeyG": Order.SUCCESS,
    "KeyF": Order.FAILURE,
    "KeyV": Order.SAVE,
    "KeyZ": Order.DISCARD,
}
"""by `KeyboardEvent.code`; none of them flies viser's camera (W A S D Q E, arrows)"""

_Code = Annotated[str, Meta(max_length=20)]
_Share = Annotated[float, Meta(ge=-1.0, le=1.0)]


class _Pad(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    axes: tuple[_Share, _Share, _Share, _Share]
    buttons: Annotated[list[Annotated[int, Meta(ge=0, le=31)]], Meta(max_length=32)]


class _Said(msgspec.Struct, forbid_unknown_fields=True, frozen=True):
    """One message of a station."""

    station: Annotated[str, Meta(max_length=40)] | None = None
    """which page it belongs to, first of all"""
    keys: Annotated[list[_Code], Meta(max_length=MOST_KEYS)] | None = None
    """the held ones; with it comes the gamepad, and a heartbeat"""
    pad: _Pad | None = None
    order: Order | None = None
    value: float = 1.0


_decode = msgspec.json.Decoder(_Said).decode


class OperatorSocket:
    """Serves every station, and knows which of them belong to which of viser's pages."""

    def __init__(self, cockpit: Cockpit) -> None:
        self.cockpit = cockpit
        self._codes = {code for binding in cockpit.guide for code in binding.codes}
        self._pages: dict[str, str] = {}
        self._numbers = count()

    def script(self, page: int) -> str:
        """The JavaScript for viser's page of that number; it alone is told its key."""
        key = secrets.token_urlsafe(16)
        self._pages[key] = station_of(page)
        operated = bool(self._codes)
        hotkeys = {
            code: order.value for code, order in HOTKEYS.items() if operated or order in OF_ANY_RUN
        }
        settings = {"station": key, "path": PATH, "codes": sorted(self._codes), "hotkeys": hotkeys}
        return f"({SCRIPT.read_text()})({json.dumps(settings)})"

    def forget(self, page: int) -> None:
        """A page is gone, and with it its right to drive."""
        station = station_of(page)
        self._pages = {key: each for key, each in self._pages.items() if each != station}
        self.cockpit.leave(station)

    async def serve(self, connection: ServerConnection) -> None:
        """Serve one station until it goes; what it says that is no message is not heard."""
        own = station = f"socket {next(self._numbers)}"
        shower = asyncio.create_task(self._show(connection, lambda: station))
        try:
            while True:
                raw = await connection.recv()
                said = self._heard(raw)
                if said is not None:
                    if said.station is not None:
                        station = self._pages.get(said.station, own)
                    self._follow(station, said)
                await asyncio.sleep(LEAST_GAP_S)
        except ConnectionClosed:
            pass
        finally:
            shower.cancel()
            # The page itself may live on, and its script connects again.
            if station == own:
                self.cockpit.leave(own)

    def _heard(self, raw: str | bytes) -> _Said | None:
        if not isinstance(raw, str) or len(raw) > LONGEST_MESSAGE:
            return None
        try:
            return _decode(raw)
        except (msgspec.DecodeError, UnicodeEncodeError, RecursionError):
            return None

    def _follow(self, station: str, said: _Said) -> None:
        if said.keys is not None:
            keys = self._codes.intersection(said.keys)
            pad = said.pad
            given = Given(
                frozenset(keys),
                None if pad is None else Gamepad(pad.axes, frozenset(pad.buttons)),
            )
            self.cockpit.give(station, given)
        if said.order is not None and math.isfinite(said.value):
            self.cockpit.order(self._meant(said.order), station, said.value)

    def _meant(self, order: Order) -> Order:
        """One key pauses and resumes."""
        resumes = order is Order.PAUSE and self.cockpit.paused
        return Order.RESUME if resumes else order

    async def _show(self, connection: ServerConnection, station_now) -> None:
        shown = ""
        with suppress(ConnectionClosed):
            while True:
                state = asdict(self.cockpit.state)
                operator = state.pop("operator")
                state["mine"] = operator is not None and operator == station_now()
                state["others"] = operator is not None and not state["mine"]
                state["left_s"] = round(state["left_s"]) if math.isfinite(state["left_s"]) else None
                news = json.dumps(state)
                if news != shown:
                    await connection.send(news)
                    shown = news
                await asyncio.sleep(SHOWN_EVERY_S)


def station_of(page: int) -> str:
    """What the cockpit calls the page that viser counts so."""
    return f"page {page}"
