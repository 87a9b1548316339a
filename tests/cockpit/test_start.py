"""A run begins when a person says so, and what it waits for costs no step."""

import threading

import pytest

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.cockpit.start import UntilReady
from sheath_manip.exceptions import UnattendedError
from sheath_manip.types import Actor
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
    assert cockpit.state.idle_s is None
    cockpit.note_episode(runs=False)
    clock.s += 7.5
    assert cockpit.state.idle_s == 7
    cockpit.note_episode(runs=True)
    assert cockpit.state.idle_s is None
