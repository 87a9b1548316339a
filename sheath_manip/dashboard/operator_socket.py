"""The page's own websocket: held keys, gamepad, orders and heartbeat in; what to show out.

Beside viser's, because viser knows no held keys, no gamepad and no heartbeat. The page's script
(`page_script`) speaks it, and so may any program that has the cookie.
"""

import asyncio
import json
import math
import secrets
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict, dataclass
from itertools import count

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed
from websockets.protocol import State

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.cockpit.orders import OF_ANY_RUN
from sheath_manip.dashboard import pictures_socket
from sheath_manip.dashboard.message_age import Budget, MessageAge
from sheath_manip.dashboard.operator_message import OperatorMessage, decoded
from sheath_manip.dashboard.page_script import page_script
from sheath_manip.dashboard.picture_age import OLDEST_S, PictureAge

PATH = "/keys"
"""below the page's own"""
SHOWN_EVERY_S = 0.1
SAID_AGAIN_S = 0.5
"""without news, so that the page knows the connection from a dead one"""
YOUNG_S = 0.5
"""of a picture whose age need not be said"""
_YIELD_EVERY = 16
"""messages that have come at once, before the other connections of the page have their turn"""
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
    "KeyC": Order.CALL_OFF,
}
NEXT_KEY = "KeyX"
"""shows the next of several robots"""
"""by `KeyboardEvent.code`; none of them flies viser's camera (W A S D Q E, arrows)"""


@dataclass(frozen=True)
class Looks:
    """How a page is to look, as its browser says."""

    dark: bool = False
    narrow: bool = False
    """whether its window is a small one"""


class OperatorSocket:
    """Serves every station, and knows which of them belong to which of viser's pages."""

    def __init__(self, cockpit: Cockpit, title: str = "sheath") -> None:
        """Take what the pages of `cockpit` say; `title` is what their tabs are called."""
        self.cockpit = cockpit
        self._title = title
        self._open: set[ServerConnection] = set()
        self._codes = {code for binding in cockpit.guide for code in binding.codes}
        self._pages: dict[str, str] = {}
        self._pictures: dict[str, PictureAge] = {}
        self._numbers = count()
        self.on_looks: Callable[[str, Looks], None] = lambda *_: None
        """called with a station and how its page is to look, as soon as it says so"""
        self._farewell: dict[str, bool | str] = {}
        """what all pages are told once the run has ended"""

    def script(self, page: int) -> str:
        """The JavaScript for viser's page of that number; it alone is told its key."""
        key = secrets.token_urlsafe(16)
        self._pages[key] = station_of(page)
        operated = bool(self._codes)
        hotkeys = {
            code: order.value for code, order in HOTKEYS.items() if operated or order in OF_ANY_RUN
        }
        if self.cockpit.state.robots:
            hotkeys[NEXT_KEY] = Order.NEXT.value
        settings = {
            "station": key,
            "path": PATH,
            "pictures": pictures_socket.PATH,
            "guide": [asdict(binding) for binding in self.cockpit.guide],
            "hotkeys": hotkeys,
            "title": self._title,
        }
        return page_script(settings)

    def follow_picture(self, page: int) -> PictureAge:
        """Have that page drive only by a picture that is not too old."""
        age = self._pictures[station_of(page)] = PictureAge()
        return age

    def forget(self, page: int) -> None:
        """A page is gone, and with it its right to drive."""
        station = station_of(page)
        self._pictures.pop(station, None)
        self._pages = {key: each for key, each in self._pages.items() if each != station}
        self.cockpit.leave(station)

    async def serve(self, connection: ServerConnection) -> None:
        """Serve one station until it goes; what it says that is no message is not heard.

        Messages are taken as fast as they come, so that none waits behind others: an order acts at
        once, and of what is held only the newest message counts.
        """
        own = station = f"socket {next(self._numbers)}"
        shower = asyncio.create_task(self._show(connection, lambda: station))
        age, budget = MessageAge(), Budget()
        self._open.add(connection)
        try:
            for number in count(1):
                said = decoded(await connection.recv())
                arrived_s = time.monotonic()
                # What is still to be read of a station that has gone is no sign of life.
                heard = connection.state is State.OPEN and not budget.exceeded(arrived_s)
                if said is not None:
                    if said.station is not None:
                        station = self._pages.get(said.station, own)
                        self.on_looks(station, Looks(bool(said.dark), bool(said.narrow)))
                    age_s = age.of(said.clock, arrived_s)
                    if heard:
                        self._take(station, said, age_s)
                    self._follow(station, said)
                if not heard:
                    self.cockpit.silence(station)
                if number % _YIELD_EVERY == 0:
                    await asyncio.sleep(0)
        except ConnectionClosed:
            pass
        finally:
            self._open.discard(connection)
            shower.cancel()
            self.cockpit.leave(own)
            # A page may live on without its socket, and its script connects again.
            self.cockpit.silence(station)

    async def say_finished(self, saved_in: str) -> None:
        """Tell every page that the run has ended, so that none takes it for a lost connection."""
        self._farewell = {"finished": True, "saved_in": saved_in}
        news = json.dumps(self._farewell)
        saying = [connection.send(news) for connection in self._open]
        await asyncio.gather(*saying, return_exceptions=True)

    def _take(self, station: str, said: OperatorMessage, age_s: float) -> None:
        operator_input = said.input(self._codes)
        picture = self._pictures.get(station)
        if picture is not None and said.saw is not None:
            picture.saw(said.saw)
        if operator_input is None:
            return
        if picture is not None and picture.age_s > OLDEST_S:
            # Who sees the past does not drive by it; the robot holds.
            self.cockpit.silence(station)
        else:
            self.cockpit.submit_input(station, operator_input, age_s)

    def _follow(self, station: str, said: OperatorMessage) -> None:
        if said.order is not None and math.isfinite(said.value):
            meant = self._meant(said.order)
            self.cockpit.order(meant, station, said.value, said.shown)

    def _meant(self, order: Order) -> Order:
        """One key pauses and resumes."""
        resumes = order is Order.PAUSE and self.cockpit.paused
        return Order.RESUME if resumes else order

    async def _show(self, connection: ServerConnection, station_now) -> None:
        shown, said_s = "", 0.0
        with suppress(ConnectionClosed):
            while True:
                state = asdict(self.cockpit.state)
                operator = state.pop("operator")
                state["mine"] = operator is not None and operator == station_now()
                state["others"] = operator is not None and not state["mine"]
                state["left_s"] = round(state["left_s"]) if math.isfinite(state["left_s"]) else None
                picture = self._pictures.get(station_now())
                state["picture_s"] = 0.0 if picture is None else _worth_saying(picture.age_s)
                state["too_old"] = picture is not None and picture.age_s > OLDEST_S
                news = json.dumps(state | self._farewell)
                if news != shown or time.monotonic() - said_s > SAID_AGAIN_S:
                    await connection.send(news)
                    shown, said_s = news, time.monotonic()
                await asyncio.sleep(SHOWN_EVERY_S)


def _worth_saying(age_s: float) -> float:
    return round(age_s, 1) if age_s > YOUNG_S else 0.0


def station_of(page: int) -> str:
    """Return what the cockpit calls the page that viser counts so."""
    return f"page {page}"
