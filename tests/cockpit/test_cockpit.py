"""Orders, lease and input, without page and without robot; time is the test's."""

from collections.abc import Callable

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, OperatorInput, Order
from sheath_manip.cockpit.cockpit import Ending
from sheath_manip.cockpit.lease import FREE_AFTER_S, LOST_AFTER_S
from sheath_manip.cockpit.orders import FASTEST, SLOWEST
from sheath_manip.cockpit.shown import Shown
from sheath_manip.cockpit.transitions import MOST_STEPS, UNDO_S, let_on
from sheath_manip.types import Outcome
from sheath_manip.types.operator_input import Binding
from tests.cockpit.clock import Clock

GUIDE = (Binding(("KeyI",), "on"),)
KEYS = OperatorInput(keys=frozenset({"KeyI"}))


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def cockpit(clock) -> Cockpit:
    return Cockpit(GUIDE, clock)


def test_one_drives_and_others_watch(cockpit):
    assert cockpit.order(Order.TAKE_OVER, "one")
    assert cockpit.submit_input("one", KEYS)
    assert not cockpit.order(Order.TAKE_OVER, "two")
    assert not cockpit.submit_input("two", OperatorInput())
    assert not cockpit.drag("two", np.zeros(7))
    for order in (Order.PAUSE, Order.HAND_BACK, Order.DISCARD, Order.SPEED, Order.RESET):
        assert not cockpit.order(order, "two")
    now = cockpit.now()
    assert now.taken
    assert now.input is not None
    assert now.input.keys == {"KeyI"}
    assert cockpit.state.operator == "one"
    assert cockpit.order(Order.HAND_BACK, "one")
    assert not cockpit.now().taken
    assert cockpit.order(Order.TAKE_OVER, "two")


def test_without_a_heartbeat_the_input_is_empty_and_later_the_lease_is_free(cockpit, clock):
    cockpit.order(Order.TAKE_OVER, "one")
    cockpit.submit_input("one", KEYS)
    clock.s += LOST_AFTER_S - 0.01
    assert cockpit.now().input is not None
    clock.s += 0.02
    assert cockpit.now().input is None
    assert cockpit.now().taken
    assert not cockpit.order(Order.TAKE_OVER, "two")
    assert cockpit.submit_input("one", OperatorInput())
    assert cockpit.now().input is not None
    clock.s += FREE_AFTER_S + 0.01
    now = cockpit.now()
    assert not now.taken
    assert now.abandoned
    assert cockpit.order(Order.TAKE_OVER, "two")
    now = cockpit.now()
    assert now.taken
    assert not now.abandoned
    # What the one before held is not the next one's.
    assert now.input is not None
    assert not now.input.keys


def test_a_page_that_is_left_abandons_and_does_not_hand_back(cockpit):
    cockpit.order(Order.TAKE_OVER, "one")
    cockpit.now()
    cockpit.leave("two")
    assert cockpit.now().taken
    cockpit.leave("one")
    assert cockpit.now().abandoned


def test_anyone_may_stop_and_the_stop_is_latched(cockpit):
    cockpit.order(Order.TAKE_OVER, "one")
    assert cockpit.order(Order.STOP, "two")
    assert cockpit.now().stopped
    cockpit.order(Order.HAND_BACK, "one")
    assert cockpit.now().stopped
    assert cockpit.order(Order.RESET, "two", shown=Shown(stops=1))
    assert not cockpit.now().stopped
    # A reset by itself moves nothing.
    assert cockpit.paused
    assert cockpit.now().halted
    assert cockpit.order(Order.RESUME, "two")
    cockpit.wait()
    assert not cockpit.paused
    assert not cockpit.now().halted


@pytest.mark.parametrize("order", [Order.SUCCESS, Order.FAILURE, Order.SAVE, Order.DISCARD])
def test_who_ends_an_episode_that_is_over_does_not_end_the_next(cockpit, order):
    cockpit.begin_episode()
    shown = Shown(episode=cockpit.state.episode)
    cockpit.begin_episode()
    assert not cockpit.order(order, "one", shown=shown)
    assert (cockpit.ending, cockpit.discarding) == (None, False)
    assert cockpit.order(order, "one", shown=Shown(episode=cockpit.state.episode))


def test_a_reset_without_a_stop_does_nothing(cockpit):
    for seen in (None, 0, 1):
        assert not cockpit.order(Order.RESET, "one", shown=Shown(stops=seen))
    cockpit.now()
    assert not cockpit.paused


@pytest.mark.parametrize("seen", [None, 0, 1, 3])
def test_a_reset_clears_only_the_stop_that_its_giver_has_seen(cockpit, seen):
    cockpit.order(Order.STOP, "one")
    assert cockpit.state.stops == 1
    cockpit.order(Order.STOP, "two")
    assert not cockpit.order(Order.RESET, "one", shown=Shown(stops=seen))
    assert cockpit.now().stopped
    assert cockpit.order(Order.RESET, "one", shown=Shown(stops=2))
    assert not cockpit.now().stopped


def test_stop_reset_resume_stop_in_one_breath_ends_stopped(cockpit):
    cockpit.order(Order.STOP, "one")
    assert cockpit.order(Order.RESET, "one", shown=Shown(stops=1))
    assert cockpit.order(Order.RESUME, "one", shown=Shown(stops=1))
    cockpit.order(Order.STOP, "one")
    # What was under way meanwhile is void.
    for order in (Order.RESET, Order.RESUME, Order.STEP, Order.TAKE_OVER, Order.HAND_BACK):
        assert not cockpit.order(order, "two", shown=Shown(stops=1))
    now = cockpit.now()
    assert now.stopped
    assert now.halted
    assert cockpit.order(Order.RESET, "one", shown=Shown(stops=2))
    assert cockpit.paused


def test_a_stop_voids_steps_takeover_and_resume(cockpit):
    cockpit.order(Order.TAKE_OVER, "one")
    cockpit.order(Order.PAUSE, "one")
    cockpit.order(Order.STEP, "one")
    cockpit.order(Order.STOP, "two")
    for order in (Order.RESUME, Order.STEP, Order.TAKE_OVER):
        assert not cockpit.order(order, "one", shown=Shown(stops=1))
    assert not cockpit.submit_input("one", KEYS)
    cockpit.order(Order.RESET, "two", shown=Shown(stops=1))
    now = cockpit.now()
    assert now.halted
    assert now.abandoned
    assert not now.taken
    # Exactly the one step that was ordered after the reset.
    assert cockpit.order(Order.STEP, "two", shown=Shown(stops=1))
    assert not cockpit.now().halted
    assert cockpit._standing.steps == 0
    assert cockpit.order(Order.TAKE_OVER, "one", shown=Shown(stops=1))
    assert cockpit.now().taken


def test_anyone_lets_the_policy_go_on_where_who_drove_is_lost(cockpit):
    assert not cockpit.order(Order.HAND_BACK, "two")
    cockpit.order(Order.TAKE_OVER, "one")
    assert not cockpit.order(Order.HAND_BACK, "two")
    cockpit.leave("one")
    cockpit.begin_episode()
    assert cockpit.now().abandoned
    assert cockpit.order(Order.HAND_BACK, "two")
    assert not cockpit.now().abandoned


def test_what_is_too_old_is_no_sign_of_life(cockpit, clock):
    cockpit.order(Order.TAKE_OVER, "one")
    clock.s += LOST_AFTER_S + 0.01
    cockpit.submit_input("one", KEYS, age_s=LOST_AFTER_S + 0.01)
    assert cockpit.now().input is None
    cockpit.submit_input("one", KEYS, age_s=LOST_AFTER_S - 0.1)
    assert cockpit.now().input is not None
    clock.s += 0.11
    assert cockpit.now().input is None


def test_who_is_silenced_holds_nothing_until_it_is_heard_again(cockpit):
    cockpit.order(Order.TAKE_OVER, "one")
    cockpit.submit_input("one", KEYS)
    cockpit.drag("one", np.zeros(7))
    cockpit.silence("two")
    assert cockpit.now().input is not None
    cockpit.silence("one")
    now = cockpit.now()
    assert now.taken
    assert now.input is None
    cockpit.submit_input("one", OperatorInput())
    now = cockpit.now()
    assert now.input is not None
    assert not now.input.held


def test_speed_is_clamped(cockpit):
    for wanted, given in ((1e9, FASTEST), (-3.0, SLOWEST), (float("nan"), 1.0), (2.0, 2.0)):
        cockpit.order(Order.SPEED, "one", wanted)
        cockpit.now()
        assert cockpit.speed == given


def test_a_paused_run_goes_step_by_step(cockpit):
    cockpit.order(Order.PAUSE, "one")
    for _ in range(3):
        cockpit.order(Order.STEP, "one")
    for _ in range(3):
        cockpit.wait()
    assert cockpit.paused
    cockpit.order(Order.SAVE, "one")
    # Ending the episode lets it go on to its end.
    cockpit.wait()
    assert cockpit.ending is Ending.SAVE
    cockpit.begin_episode()
    assert cockpit.ending is None
    cockpit.close()
    cockpit.wait()


@pytest.mark.parametrize(
    ("order", "outcome"),
    [
        (Order.SUCCESS, Outcome.SUCCESS),
        (Order.FAILURE, Outcome.FAILURE),
        (Order.SAVE, None),
        (Order.DISCARD, None),
    ],
)
def test_marks(cockpit, clock, order, outcome):
    cockpit.order(order, "one")
    clock.s += UNDO_S
    cockpit.now()
    assert cockpit.mark is outcome
    assert cockpit.ending is not None


def test_a_discard_can_be_called_off_and_all_rests_meanwhile(cockpit, clock):
    assert not cockpit.order(Order.CALL_OFF, "one")
    cockpit.order(Order.DISCARD, "one")
    assert cockpit.ending is None
    assert cockpit.state.discard_s == UNDO_S
    assert let_on(cockpit._standing) is None
    # To press it again does not take longer, nor less.
    clock.s += 2
    cockpit.order(Order.DISCARD, "one")
    assert cockpit.state.discard_s == UNDO_S - 2
    assert cockpit.order(Order.CALL_OFF, "another")
    clock.s += UNDO_S
    assert cockpit.state.discard_s is None
    assert cockpit.ending is None
    cockpit.wait()

    cockpit.order(Order.DISCARD, "one")
    clock.s += UNDO_S
    assert not cockpit.order(Order.CALL_OFF, "one")
    assert cockpit.now().ending is Ending.DISCARD
    cockpit.begin_episode()
    # Another word on how it ends counts in place of it.
    cockpit.order(Order.DISCARD, "one")
    cockpit.order(Order.SUCCESS, "one")
    clock.s += UNDO_S
    assert cockpit.ending is Ending.SUCCESS


def test_single_steps_do_not_pile_up(cockpit):
    cockpit.order(Order.PAUSE, "one")
    for _ in range(3 * MOST_STEPS):
        assert cockpit.order(Order.STEP, "one")
    assert cockpit._standing.steps == MOST_STEPS
    assert cockpit.order(Order.STOP, "one")
    assert cockpit.now().stopped


def test_who_may_not_drive_cannot(clock):
    cockpit = Cockpit(clock=clock)
    assert not cockpit.order(Order.TAKE_OVER, "one")
    assert not cockpit.order(Order.HAND_BACK, "one")
    # There is nothing that would act on it, and the page must not say that there were.
    assert not cockpit.order(Order.STOP, "one")
    assert not cockpit.order(Order.DISCARD, "one")
    assert not cockpit.state.stopped
    assert cockpit.order(Order.PAUSE, "one")


def test_a_call_from_the_page_returns_at_once(cockpit):
    calls: list[Callable[[], object]] = [
        lambda: cockpit.order(Order.PAUSE, "one"),
        lambda: cockpit.submit_input("one", KEYS),
        lambda: cockpit.state,
        lambda: cockpit.leave("one"),
    ]
    for call in calls:
        call()
    assert cockpit.paused
