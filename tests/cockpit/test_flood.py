"""Who floods the page's websocket: letting go, stop and close act within half a second."""

import json
import math
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit
from sheath_manip.cockpit.lease import LOST_AFTER_S
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.message_age import MOST_PER_S, Budget, MessageAge
from tests.stopwatch import Stopwatch
from tests.toy import Corridor, teleop
from tests.waiting import eventually
from tools.station import Station, open_socket

PROMISED_S = 0.5
TRIES = 3
AT_ONCE = 4000
PER_S, FOR_S = 1000, 2.0
HELD = json.dumps({"keys": ["KeyJ"]})
LET_GO = json.dumps({"keys": []})
STOP = json.dumps({"order": "emergency-stop"})
TAKE_OVER = json.dumps({"order": "take-over"})


@pytest.fixture
def cockpit() -> Cockpit:
    return Cockpit(teleop(Corridor()).guide, paced=True)


@pytest.fixture
def page(cockpit) -> Iterator[Dashboard]:
    with Dashboard(Corridor().spec, port=0, cockpit=cockpit) as page:
        yield page


def drives(cockpit: Cockpit) -> bool:
    given = cockpit.now().input
    return given is not None and given.held


def frame(text: str | bytes, opcode: int = 1) -> bytes:
    """As a client sends it, masked by nothing."""
    payload = text.encode() if isinstance(text, str) else text
    assert len(payload) < 126
    return bytes((0x80 | opcode, 0x80 | len(payload), 0, 0, 0, 0)) + payload


CLOSE = frame((1000).to_bytes(2, "big"), opcode=8)
ACTS = {"let go": frame(LET_GO), "stop": frame(STOP), "close": CLOSE, "crash": b""}


def drives_no_more(cockpit: Cockpit) -> bool:
    return not drives(cockpit)


def stopped(cockpit: Cockpit) -> bool:
    return cockpit.now().stopped


def lost(cockpit: Cockpit) -> bool:
    return cockpit.now().abandoned


ACTED = {"let go": drives_no_more, "stop": stopped, "close": lost, "crash": lost}


def seconds_until(act: str, cockpit: Cockpit, raw: socket.socket, before: bytes) -> float:
    """How long it takes that `act` acts, which follows `before` in the same breath."""
    watch = Stopwatch()
    raw.sendall(before + ACTS[act])
    if act == "crash":
        raw.shutdown(socket.SHUT_RDWR)
    assert eventually(lambda: ACTED[act](cockpit))
    return watch.took_s


@contextmanager
def driving() -> Iterator[tuple[Cockpit, socket.socket]]:
    """A cockpit of its own, and the bare TCP connection of who drives."""
    cockpit = Cockpit(teleop(Corridor()).guide, paced=True)
    with (
        Dashboard(Corridor().spec, port=0, cockpit=cockpit) as page,
        open_socket(page.address) as connection,
    ):
        connection.send(TAKE_OVER)
        connection.send(HELD)
        assert eventually(lambda: drives(cockpit))
        yield cockpit, connection.socket
        with suppress(OSError):
            connection.socket.shutdown(socket.SHUT_RDWR)


def best_s(measured_s: Callable[[], float]) -> float:
    """Of a few tries: what delays a machine beside its other programs is no fault of the page's.

    The server computes for .05 s behind 4,000 messages, whatever the machine's load.
    """
    took_s = math.inf
    for _ in range(TRIES):
        took_s = min(took_s, measured_s())
        if took_s < PROMISED_S:
            break
    return took_s


@pytest.mark.parametrize("number", [MOST_PER_S / 2, AT_ONCE])
@pytest.mark.parametrize("act", ACTS)
def test_it_acts_within_half_a_second_of_many_messages_at_once(act, number):
    def measured_s() -> float:
        with driving() as (cockpit, raw):
            took_s = seconds_until(act, cockpit, raw, int(number) * frame(HELD))
            # Nothing that is still under way brings it back.
            time.sleep(0.1)
            assert not drives(cockpit)
            return took_s

    took_s = best_s(measured_s)
    print(f"{act} after {number:g} at once: {took_s:.3f} s")
    assert took_s < PROMISED_S


@pytest.mark.parametrize(
    "act",
    ["stop", *(pytest.param(act, marks=pytest.mark.soak) for act in ACTS if act != "stop")],
)
def test_it_acts_within_half_a_second_of_many_messages_a_second(act):
    def measured_s() -> float:
        with driving() as (cockpit, raw):
            began_s, drove = time.monotonic(), []
            for number in range(int(PER_S * FOR_S)):
                raw.sendall(frame(HELD))
                if number % 50 == 0:
                    drove.append(drives(cockpit))
                time.sleep(max(0.0, began_s + number / PER_S - time.monotonic()))
            took_s = seconds_until(act, cockpit, raw, b"")
            time.sleep(0.1)
            assert not drives(cockpit)
            # So many it may send, and still drive by the newest; a stall may hold meanwhile.
            return took_s if np.mean(drove) > 0.5 else math.inf

    took_s = best_s(measured_s)
    print(f"{act} after {PER_S} a second: {took_s:.3f} s")
    assert took_s < PROMISED_S


def test_others_are_heard_while_one_floods(page, cockpit):
    """The event loop that serves all of them has turns to give."""
    enough = threading.Event()

    def flood() -> None:
        with open_socket(page.address) as flooding:
            while not enough.is_set():
                flooding.send(HELD)

    thread = threading.Thread(target=flood, daemon=True)
    with Station(page.address) as station:
        thread.start()
        try:
            time.sleep(0.5)
            watch = Stopwatch()
            station.order("emergency-stop")
            assert eventually(lambda: cockpit.state.stopped)
            assert watch.took_s < PROMISED_S
            station.until(lambda shown: shown["stopped"])
            assert watch.took_s < 2 * PROMISED_S
        finally:
            enough.set()
            thread.join()


def test_who_says_too_much_is_not_heard_and_so_holds_but_its_stop_is(page, cockpit):
    with open_socket(page.address) as flooding:
        flooding.send(TAKE_OVER)
        for _ in range(int(2 * MOST_PER_S)):
            flooding.send(HELD)
        flooding.send(json.dumps({"order": "pause"}))
        assert eventually(lambda: cockpit.paused)
        assert cockpit.now().input is None
        flooding.send(STOP)
        assert eventually(lambda: cockpit.state.stopped)


def test_it_is_heard_again_once_it_has_calmed_down(page, cockpit):
    with open_socket(page.address) as flooding:
        flooding.send(TAKE_OVER)
        for _ in range(int(2 * MOST_PER_S)):
            flooding.send(HELD)
        time.sleep(1.2)
        flooding.send(HELD)
        assert eventually(lambda: drives(cockpit))


def test_messages_that_were_long_under_way_are_no_heartbeat(page, cockpit):
    with open_socket(page.address) as flooding:

        def say(held: str, sent_s: float) -> None:
            flooding.send(json.dumps({"keys": [held], "clock": sent_s * 1000}))

        flooding.send(TAKE_OVER)
        say("KeyJ", time.monotonic())
        assert eventually(lambda: drives(cockpit))
        assert eventually(lambda: not drives(cockpit))
        for _ in range(5):
            say("KeyL", time.monotonic() - LOST_AFTER_S - 0.1)
        flooding.send(json.dumps({"order": "pause"}))
        assert eventually(lambda: cockpit.paused)
        assert not drives(cockpit)
        say("KeyL", time.monotonic())
        assert eventually(lambda: drives(cockpit))


def test_the_age_is_what_a_message_took_longer_than_the_fastest():
    age = MessageAge()
    assert age.of(5000.0, 100.3) == 0.0
    assert age.of(5100.0, 100.2) == 0.0
    assert age.of(5200.0, 100.8) == pytest.approx(0.5, abs=0.01)
    assert age.of(None, 200.0) == 0.0


def test_a_clock_that_is_a_little_slower_does_not_make_a_days_messages_old():
    age = MessageAge()
    assert max(age.of(0.9999 * 1000 * s, 101.0 + s) for s in range(86400)) < 0.01


def test_the_budget_wants_a_moment_of_calm():
    budget = Budget(10.0)
    assert not any(budget.exceeded(1.0) for _ in range(10))
    assert budget.exceeded(1.0)
    # Slower again, but the bucket is still more than half full.
    assert budget.exceeded(1.3)
    assert not budget.exceeded(2.0)
    assert not any(budget.exceeded(2.0 + number / 9) for number in range(1, 100))
