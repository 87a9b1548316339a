"""Several threads stop, reset and resume at once while the loop runs: each stop counts."""

import random
import threading
import time

import numpy as np

from sheath_manip.cockpit import Cockpit, Order, PersonGate
from sheath_manip.cockpit.shown import Shown
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.types import Actor, Observation, Proposal
from sheath_manip.types.operator_input import Binding

PAGES, ROUNDS = 6, 300
SEEN = Observation({}, np.zeros(1, np.float32), 0.0)
AT_REST = Proposal(np.zeros((1, 1), np.float32))


class Numbers:
    """The highest number so far, of many threads."""

    def __init__(self) -> None:
        self.highest = 0
        self._lock = threading.Lock()

    def add(self, number: int) -> None:
        with self._lock:
            self.highest = max(self.highest, number)


def test_no_stop_is_lost_and_nothing_moves_that_nobody_has_reset(monkeypatch):
    # As often as the interpreter can.
    monkeypatch.setattr("sheath_manip.cockpit.cockpit._GLANCE_S", 0.0005)
    cockpit = Cockpit((Binding(("KeyI",), "on"),))
    gate = PersonGate(AlwaysPolicy(), cockpit, 20.0)
    gate.reset(np.random.default_rng(0))
    pressed, reset = Numbers(), Numbers()
    begin, enough = threading.Barrier(PAGES + 1), threading.Event()
    moved, wrong = [0], []

    def page(station: str) -> None:
        rng = random.Random(station)
        begin.wait()
        for _ in range(ROUNDS):
            assert cockpit.order(Order.STOP, station)
            seen = cockpit.state.stops
            pressed.add(seen)
            # Another page may stop meanwhile.
            time.sleep(rng.uniform(0.0, 0.001))
            # Said before it is done: the loop may look in between.
            reset.add(seen)
            newest = cockpit.state.stops
            if cockpit.order(Order.RESET, station, shown=Shown(stops=seen)) and newest > seen:
                wrong.append(newest)
            cockpit.order(Order.RESUME, station, shown=Shown(stops=seen))
        cockpit.order(Order.STOP, station)
        pressed.add(cockpit.state.stops)

    def loop() -> None:
        begin.wait()
        while not enough.is_set():
            known = pressed.highest
            if gate.decide(SEEN, AT_REST).actor is not Actor.HOLD:
                moved[0] += 1
                if reset.highest < known:
                    wrong.append(known)
            cockpit.wait()

    pages = [threading.Thread(target=page, args=(f"page {number}",)) for number in range(PAGES)]
    running = threading.Thread(target=loop, daemon=True)
    for thread in (*pages, running):
        thread.start()
    for thread in pages:
        thread.join()
    enough.set()
    cockpit.close()
    running.join(10.0)
    assert not running.is_alive()
    assert not wrong
    # The last that each of them did was to stop.
    state = cockpit.state
    assert state.stops == PAGES * (ROUNDS + 1)
    assert state.stopped
    assert gate.decide(SEEN, AT_REST).actor is cockpit.turn is Actor.HOLD
    print(f"{state.stops} stops, {moved[0]} steps that moved")
