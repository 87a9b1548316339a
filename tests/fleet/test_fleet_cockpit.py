"""The person's side of several robots, without processes: what is shown and passed on."""

import time
from dataclasses import replace

import pytest

from sheath_manip.cockpit import Order
from sheath_manip.cockpit.standing import Standing
from sheath_manip.fleet.to_robot import Gone, Held, Silenced
from tests.fleet.told_robots import ASKS, DRIVES, LEFT, SERVED, Robots, Told


@pytest.fixture
def robots() -> Robots:
    return Robots()


def test_a_request_is_offered_and_stays_until_it_is_answered(robots):
    robots.asks(3)
    assert robots.shown == 3
    assert robots.films[-1].info.seed == 3
    robots.asks(2, below=5.0)
    assert robots.shown == 3
    assert [each.words for each in robots.cockpit.state.robots] == [
        "driving",
        "waiting, 2nd, for 0 s",
        "asking for 0 s",
        "driving",
    ]
    assert robots.order(Order.NEXT)
    assert robots.shown == 2
    assert [each.words for each in robots.cockpit.state.robots][1:3] == [
        "asking for 0 s",
        "waiting, 2nd, for 0 s",
    ]


def test_after_the_hand_back_comes_the_most_urgent_one(robots):
    for number, below in ((1, 0.1), (2, 0.3), (3, 0.2)):
        robots.asks(number, below)
    assert robots.shown == 1
    robots.order(Order.TAKE_OVER)
    robots.says(1, SERVED)
    assert robots.shown == 1
    assert robots.cockpit.state.robots[0].words == "being served"
    robots.order(Order.HAND_BACK)
    assert robots.told[0].orders() == [Order.TAKE_OVER, Order.HAND_BACK]
    assert robots.shown == 2
    # It asks again at once, and is the most urgent one by now; the offer stands.
    robots.asks(1, below=9.0)
    assert robots.shown == 2


def test_only_what_is_shown_is_driven_and_by_one_person(robots):
    robots.asks(2)
    robots.order(Order.TAKE_OVER)
    assert robots.cockpit.submit_input("page", LEFT)
    assert not robots.cockpit.submit_input("other", LEFT)
    assert isinstance(robots.told[1].said[-1], Held)
    for order, value in ((Order.CHOOSE, 4), (Order.NEXT, 1)):
        assert not robots.order(order, value=value)
        assert not robots.order(order, "other", value=value)
    assert not robots.order(Order.TAKE_OVER, "other")
    assert not robots.order(Order.HAND_BACK, "other")
    assert robots.told[0].said[1:] == robots.told[2].said[1:] == []


def test_a_robot_that_starts_cannot_be_taken_over_before_it_is_heard_of(robots):
    seat = robots.cockpit.roster.shown
    robots.cockpit.detach(seat)
    assert not robots.order(Order.TAKE_OVER)
    robots.cockpit.attach(seat, Told())
    # Its own cockpit would be told by the program to let the policy begin, right after this.
    assert not robots.order(Order.TAKE_OVER)
    assert robots.cockpit.lease.holder is None
    robots.says(seat.number, DRIVES)
    assert robots.order(Order.TAKE_OVER)


def test_an_order_for_a_robot_that_is_no_longer_shown_is_void(robots):
    robots.asks(2)
    assert not robots.order(Order.TAKE_OVER, robot=1)
    assert robots.told[1].orders() == []
    assert robots.order(Order.TAKE_OVER, robot=2)


def test_a_person_chooses_and_the_next_request_waits_a_moment(robots):
    assert robots.order(Order.CHOOSE, value=4)
    robots.asks(1)
    assert robots.shown == 4
    for value in (0, 5, 1.5, float("nan")):
        assert not robots.order(Order.CHOOSE, value=value)


def test_a_stop_a_reset_and_a_pause_are_of_all_robots_whoever_drives(robots):
    robots.asks(1)
    robots.order(Order.TAKE_OVER)
    assert robots.order(Order.STOP, "other")
    assert all(told.orders()[-1] is Order.STOP for told in robots.told)
    assert robots.cockpit.lease.holder is None
    # What another one asked just before moves nobody away.
    robots.says(1, SERVED)
    robots.asks(3)
    assert robots.shown == 1
    assert not robots.order(Order.RESUME, seen=1)
    assert not robots.order(Order.RESET, seen=0)
    assert robots.order(Order.RESET, seen=1)
    assert robots.order(Order.RESUME, seen=1)
    assert all(told.orders()[-1] is Order.RESUME for told in robots.told)


def test_a_robot_that_comes_later_stands_as_the_others_do(robots):
    robots.order(Order.STOP)
    robots.order(Order.SPEED, value=2.0)
    seat, told = robots.cockpit.roster.seats[2], Told()
    robots.cockpit.detach(seat)
    robots.order(Order.STOP)
    robots.cockpit.attach(seat, told)
    standing = told.said[0]
    assert isinstance(standing, Standing)
    assert (standing.stops, standing.cleared, standing.speed) == (2, 0, 2.0)
    assert standing.stopped
    assert standing.halted


def test_a_page_that_is_lost_lets_go_of_its_robot(robots):
    robots.asks(2)
    robots.order(Order.TAKE_OVER)
    robots.cockpit.silence("page")
    robots.cockpit.leave("page")
    assert robots.told[1].said[-2:] == [Silenced("page"), Gone("page")]
    assert robots.cockpit.lease.holder is None
    robots.says(2, replace(ASKS, abandoned=True))
    robots.asks(3, below=9.0)
    assert [each.number for each in robots.cockpit.roster.queue()] == [2, 3]


def test_a_robot_that_is_lost_frees_the_person_for_the_others(robots):
    robots.asks(2)
    robots.asks(4)
    robots.order(Order.TAKE_OVER)
    robots.cockpit.detach(robots.cockpit.roster.seats[1])
    assert robots.cockpit.lease.holder is None
    assert robots.shown == 4
    assert robots.cockpit.state.robots[1].words == "starting"


def test_a_robot_that_is_not_heard_of_is_said_so_and_not_served(robots):
    robots.asks(2)
    seat = robots.cockpit.roster.seats[1]
    assert seat.report is not None
    seat.report = replace(seat.report, at_s=time.monotonic() - 5.0)
    assert robots.cockpit.state.robots[1].words == "not heard of for 5 s"
    assert robots.cockpit.roster.queue() == []
    # The picture of it is as old, so that nobody drives by it.
    assert time.monotonic() - robots.cockpit.true_s > 4.0


def test_all_begin_once_with_the_first_order_of_the_person(robots):
    unready = replace(DRIVES, unready=True, abandoned=True, asking=True)
    for number in (1, 2):
        robots.says(number, unready)
    assert robots.cockpit.roster.queue() == []
    robots.order(Order.TAKE_OVER)
    robots.says(2, unready)
    robots.says(3, unready)
    assert [told.orders() for told in robots.told] == [
        [Order.TAKE_OVER],
        [Order.HAND_BACK],
        [Order.HAND_BACK],
        [],
    ]


def test_who_drives_another_robot_is_gone_from_the_one_before(robots):
    """Its own cockpit may not have noticed yet that who drove it was lost."""
    robots.asks(1)
    robots.order(Order.TAKE_OVER)
    robots.cockpit.leave("page")
    robots.order(Order.CHOOSE, value=2)
    robots.order(Order.TAKE_OVER, "other")
    assert robots.told[0].said[-1] == Gone("page")
    assert robots.told[1].orders() == [Order.TAKE_OVER]
