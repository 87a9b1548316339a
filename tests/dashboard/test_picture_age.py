"""A page that shows the past: its person does not drive by it, and the robot holds."""

import asyncio
import itertools
import json
import re
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress

import msgspec
import pytest
import zstandard
from websockets.exceptions import ConnectionClosed
from websockets.sync.connection import Connection

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.drawer import Drawer
from sheath_manip.dashboard.paced_connection import MOST_UNDER_WAY, PacedConnection
from sheath_manip.dashboard.picture_age import OLDEST_S, PictureAge
from sheath_manip.types import EpisodeInfo, Purpose
from tests.cockpit.clock import Clock
from tests.toy import Corridor, teleop
from tests.waiting import DEADLINE_S, eventually
from tools.page_client import CAMERA, SUBPROTOCOL
from tools.station import open_socket


def test_a_picture_is_as_old_as_the_newest_mark_that_came_back():
    clock = Clock()
    age = PictureAge(clock)
    clock.s += 3.0
    assert age.age_s == 3.0
    first, second = age.mark(clock.s), age.mark(clock.s - 0.25)
    age.saw(second + 1)
    assert age.age_s == 3.0
    age.saw(first)
    assert age.age_s == 0.0
    age.saw(second)
    assert age.age_s == 0.25
    # What came back before says nothing new.
    age.saw(first)
    clock.s += 1.0
    assert age.age_s == 1.25


def test_a_page_that_hears_nothing_more_of_the_episode_shows_the_past():
    environment = Corridor()
    environment.reset(3)
    info = EpisodeInfo.of(environment.spec, variant="default", seed=3, purpose=Purpose.EVALUATION)
    with Dashboard(environment.spec, port=0) as page:
        page.on_start(environment, info)
        before_s = time.monotonic()
        assert eventually(lambda: page._true_s() >= before_s)
        page.on_dropped()
        left_s = time.monotonic()
        assert eventually(lambda: time.monotonic() - left_s > 0.1)
        assert page._true_s() <= left_s
        page.on_start(environment, info)
        assert eventually(lambda: page._true_s() > left_s)


def test_a_page_is_true_up_to_what_is_not_drawn_yet():
    go_on, drawing = threading.Event(), threading.Event()

    def draw() -> None:
        drawing.set()
        assert go_on.wait(DEADLINE_S)

    drawer = Drawer(draw, lambda _: None, rate_hz=100.0)
    try:
        before_s = time.monotonic()
        assert drawer.true_s >= before_s
        drawer.wake()
        assert drawing.wait(DEADLINE_S)
        asked_s = drawer.true_s
        # A drawing that hangs, and more that waits for it.
        drawer.wake()
        time.sleep(0.05)
        assert before_s <= drawer.true_s == asked_s < time.monotonic() - 0.04
        go_on.set()
        assert eventually(lambda: drawer.true_s > time.monotonic() - 0.01)
    finally:
        go_on.set()
        drawer.close()


def test_a_drawing_that_fails_leaves_the_page_as_old_as_it_is():
    failing = [True]

    def draw() -> None:
        if failing[0]:
            raise ValueError("no")

    failures: list[str] = []
    drawer = Drawer(draw, failures.append, rate_hz=100.0)
    try:
        before_s = time.monotonic()
        for number in range(1, 4):
            drawer.wake()
            assert eventually(lambda number=number: len(failures) >= number)
        assert before_s <= drawer.true_s <= before_s + 1.0
        failing[0] = False
        drawer.wake()
        assert eventually(lambda: drawer.true_s > time.monotonic() - 0.01)
    finally:
        drawer.close()


class Wire:
    """A websocket whose other end answers pings as a test wants."""

    def __init__(self) -> None:
        self.sent: list[bytes] = []
        self.pings: list[asyncio.Future[float]] = []

    async def send(self, message: bytes) -> None:
        self.sent.append(message)

    async def ping(self) -> "asyncio.Future[float]":
        self.pings.append(asyncio.get_running_loop().create_future())
        return self.pings[-1]


def test_no_more_is_under_way_than_was_answered():
    async def run() -> None:
        wire = Wire()
        paced = PacedConnection(wire)

        async def produce() -> None:
            for number in itertools.count():
                await paced.send(bytes([number]))

        producing = asyncio.create_task(produce())
        for answered in range(5):
            await asyncio.sleep(0.01)
            assert len(wire.sent) == answered + MOST_UNDER_WAY
            wire.pings[answered].set_result(0.0)
        producing.cancel()
        with suppress(asyncio.CancelledError):
            await producing

    asyncio.run(run())


class Browser:
    """viser's half of a page: it reads the stream, and knows its key and the newest mark."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection
        self.station = ""
        self.mark = 0
        connection.send(msgspec.msgpack.encode(CAMERA))
        self.thread = threading.Thread(target=self._read, daemon=True)
        self.thread.start()

    def _read(self) -> None:
        with suppress(ConnectionClosed):
            for raw in self._connection:
                assert isinstance(raw, bytes)
                length = int.from_bytes(raw[8:16], "little")
                packed = zstandard.ZstdDecompressor().decompress(raw[16 : 16 + length])
                for message in msgspec.msgpack.decode(packed)["messages"]:
                    self._hear(message.get("source", ""))

    def _hear(self, source: str) -> None:
        if found := re.search(r'"station": "([^"]+)"', source):
            self.station = found[1]
        if found := re.fullmatch(r"window\.sheathOperator\?\.saw\((\d+)\)", source):
            self.mark = int(found[1])


@pytest.fixture
def cockpit() -> Cockpit:
    return Cockpit(teleop(Corridor()).guide, paced=True)


@pytest.fixture
def page(cockpit) -> Iterator[Dashboard]:
    with Dashboard(Corridor().spec, port=0, cockpit=cockpit) as page:
        yield page


@contextmanager
def driving(page: Dashboard, marks: threading.Event) -> Iterator[None]:
    """A person whose browser says its marks back only while that is set."""
    enough = threading.Event()
    with (
        open_socket(page.address, "", subprotocols=[SUBPROTOCOL], max_size=None) as stream,
        open_socket(page.address) as own,
    ):
        browser = Browser(stream)
        assert eventually(lambda: bool(browser.station) and browser.mark > 0)
        own.send(json.dumps({"station": browser.station}))
        own.send(json.dumps({"order": "take-over"}))

        def beat() -> None:
            said = 0
            while not enough.wait(0.05):
                said = browser.mark if marks.is_set() else said
                own.send(json.dumps({"keys": ["KeyJ"], "saw": said}))

        thread = threading.Thread(target=beat, daemon=True)
        thread.start()
        try:
            yield
        finally:
            enough.set()
            thread.join(DEADLINE_S)
    browser.thread.join(DEADLINE_S)


def drives(cockpit: Cockpit) -> bool:
    given = cockpit.now().input
    return given is not None and given.held


def holds(cockpit: Cockpit) -> bool:
    return cockpit.now().must_hold


def test_who_sees_the_past_does_not_drive(page, cockpit):
    marks = threading.Event()
    marks.set()
    with driving(page, marks):
        assert eventually(lambda: drives(cockpit))
        # Also while there is nothing new to draw.
        time.sleep(OLDEST_S + 0.3)
        assert drives(cockpit)
        marks.clear()
        began_s = time.monotonic()
        assert eventually(lambda: holds(cockpit))
        assert time.monotonic() - began_s > OLDEST_S / 2
        assert cockpit.state.taken
        marks.set()
        assert eventually(lambda: drives(cockpit))


def test_a_drawing_that_hangs_lets_the_robot_hold(page, cockpit, monkeypatch):
    marks, go_on = threading.Event(), threading.Event()
    marks.set()
    with driving(page, marks):
        assert eventually(lambda: drives(cockpit))
        monkeypatch.setattr(page._drawer, "_draw", lambda: go_on.wait(DEADLINE_S))
        page._drawer.wake()
        assert eventually(lambda: holds(cockpit))
        assert cockpit.state.taken
        go_on.set()
        assert eventually(lambda: drives(cockpit))
