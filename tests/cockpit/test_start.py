"""A run begins when a person says so, and what it waits for costs no step."""

import threading
from dataclasses import replace

import pytest

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.cockpit.between import Pastime
from sheath_manip.cockpit.start import UntilReady
from sheath_manip.counting import announced, counted
from sheath_manip.exceptions import UnattendedError
from sheath_manip.types import Actor, Purpose
from tests.cockpit.clock import Clock
from tests.cockpit.operated_corridor import INFO
from tests.toy import Corridor, teleop
from tests.waiting import DEADLINE_S, eventually


def started(listener: UntilReady) -> tuple[threading.Thread, list[Exception]]:
    """The start of an episode in a thread of its own, and what it raised."""
    raised: list[Exception] = []

    def run() -> None:
        try:
            listener.on_start(Corridor(), INFO)
        except Exception as error:
            raised.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    return thread, raised


@pytest.mark.parametrize(
    ("order", "turn"), [(Order.HAND_BACK, "policy"), (Order.TAKE_OVER, "person")]
)
def test_a_run_waits_for_somebody_who_is_ready_once(order, turn):
    cockpit = Cockpit(teleop(Corridor()).guide)
    listener = UntilReady(cockpit)
    thread, raised = started(listener)
    assert eventually(lambda: cockpit.state.unready and cockpit.state.asking)
    assert cockpit.turn is Actor.HOLD
    # Neither of them means that anybody is there to watch.
    cockpit.order(Order.PAUSE, "page")
    cockpit.order(Order.RESUME, "page")
    assert thread.is_alive()
    assert cockpit.order(order, "page")
    thread.join(DEADLINE_S)
    assert not thread.is_alive()
    assert not raised
    assert not cockpit.state.unready
    assert cockpit.state.taken == (turn == "person")
    # The next episode begins at once.
    again, _ = started(listener)
    again.join(DEADLINE_S)
    assert not again.is_alive()


def test_a_run_whose_page_goes_before_anybody_is_ready_ends_and_says_so():
    cockpit = Cockpit(teleop(Corridor()).guide)
    thread, raised = started(UntilReady(cockpit))
    assert eventually(lambda: cockpit.state.unready)
    cockpit.close()
    thread.join(DEADLINE_S)
    assert [type(each) for each in raised] == [UnattendedError]


def test_between_two_episodes_the_page_is_told_how_long():
    clock = Clock()
    cockpit = Cockpit(teleop(Corridor()).guide, clock)
    assert cockpit.state.between is None
    cockpit.between.note_episode(runs=False)
    clock.s += 7.5
    assert cockpit.state.between == Pastime(7)
    cockpit.between.note_episode(runs=True)
    assert cockpit.state.between is None


def test_the_page_is_told_what_is_fitted_how_far_it_is_and_how_long_it_takes():
    clock = Clock()
    cockpit = Cockpit(teleop(Corridor()).guide, clock)
    between = cockpit.between
    between.note_episode(runs=False)
    said: list[Pastime | None] = []
    with announced("fitting round 1", between.note_work):
        clock.s += 1.0
        said.append(between.now)
        for _ in counted(range(4), 4):
            clock.s += 1.0
            for _ in counted(range(2), 2):
                clock.s += 1.0
            said.append(between.now)
    assert said[:2] == [
        Pastime(1, "fitting round 1"),
        Pastime(4, "fitting round 1", 12, 28),
    ]
    assert said[-1] == Pastime(13, "fitting round 1", 87, 2)
    assert between.now == Pastime(13)
    # Nobody has announced it, so nobody is told.
    assert list(counted(range(3), 3)) == [0, 1, 2]
    assert between.now == Pastime(13)


def test_an_episode_that_needs_no_person_does_not_wait_for_one():
    cockpit = Cockpit(teleop(Corridor()).guide)
    listener = UntilReady(cockpit, {Purpose.LEARNING})
    listener.on_start(Corridor(), replace(INFO, purpose=Purpose.DEMONSTRATION))
    assert not cockpit.state.unready
    # Who has taken over meanwhile is ready.
    assert cockpit.order(Order.TAKE_OVER, "page")
    listener.on_start(Corridor(), INFO)
    assert cockpit.state.taken
