"""A robot's process, the page or a driver fails: that robot holds or its episode is lost, alone."""

import logging
import os
import signal
import time
from collections.abc import Iterator
from dataclasses import replace

import pytest

from sheath_manip.cockpit import Order
from sheath_manip.cockpit.shown import Shown
from sheath_manip.playback.film import Film
from sheath_manip.types import Actor, Reason
from tests.fleet.drifting import WIDE, Breaking, Drifting, requests
from tests.fleet.served import POST, START_S, Served, served
from tests.stopwatch import Stopwatch
from tests.waiting import eventually
from tools.station import Station

PROMISED_S = 0.5
NEVER, AT_ONCE = Drifting(from_m=1e9), Drifting(from_m=-1.0)


@pytest.mark.soak
def test_robots_that_ask_hold_for_as_long_as_nobody_comes_and_what_fails_is_lost_alone():
    asked = requests(3, AT_ONCE)
    asked[1] = replace(asked[1], driver=Breaking())
    with served(2, asked) as run:
        run.begin()
        run.station.close()
        assert eventually(lambda: run.does() == ["asks", "asks"] and len(run.ran) == 1)
        time.sleep(0.5)
        assert [len(run.steps(number)) for number in (1, 2)] == [0, 0]
        assert run.words()[0].startswith(("asking for", "waiting, 2nd, for"))
        (lost,) = run.ran
        assert lost.request.info.index == 1
        assert "no such arm" in lost.fault
        assert "\n" not in lost.fault


@pytest.fixture(scope="module")
def fleet() -> Iterator[Served]:
    """Three robots whose policies drive for ever."""
    with served(3, requests(3, NEVER), replace(POST, task=WIDE)) as run:
        run.begin()
        yield run


@pytest.fixture
def run(fleet: Served) -> Iterator[Served]:
    """The same before each test: all drive, and there is a new station at the page."""
    with Station(fleet.page.address) as fleet.station:
        fleet.station.until(lambda shown: "robots" in shown)
        yield fleet
        for seat in fleet.cockpit.roster.seats:
            fleet.cockpit.order(Order.CHOOSE, None, seat.number)
            fleet.cockpit.order(Order.HAND_BACK, None)
        assert eventually(lambda: fleet.does() == ["drives"] * 3), fleet.words()


def drive(run: Served, number: int) -> None:
    """Take that robot over and drive it."""
    run.station.order("choose-robot", number)
    run.station.until(lambda shown: shown["robot"] == number)
    run.station.order("take-over")
    run.station.hold(keys=["KeyJ"])
    assert eventually(lambda: actor(run, number) is Actor.OPERATOR)


def actor(run: Served, number: int) -> Actor | None:
    steps = run.steps(number)
    return steps[-1].decision.actor if steps else None


def robot(run: Served, number: int) -> tuple[Film, int]:
    """Its present episode, and the number of its process."""
    film = run.cockpit.roster.seats[number - 1].film
    process = next(each.process for each in run.fleet.robots if each.seat.number == number)
    assert film is not None
    assert process.pid is not None
    return film, process.pid


def stopwatch(run: Served) -> Stopwatch:
    return Stopwatch([robot(run, number)[1] for number in (1, 2, 3)])


def test_an_emergency_stop_holds_all_within_half_a_second(run):
    drive(run, 2)
    watch = stopwatch(run)
    run.station.order("emergency-stop")
    assert eventually(lambda: [actor(run, n) for n in (1, 2, 3)] == [Actor.HOLD] * 3)
    assert watch.took_s < PROMISED_S
    made = [len(run.steps(n)) for n in (1, 2, 3)]
    time.sleep(0.3)
    for number, before in zip((1, 2, 3), made, strict=True):
        after = run.steps(number)[before:]
        assert {step.decision.reason for step in after} <= {Reason.EMERGENCY_STOP}
    assert run.does() == ["held"] * 3
    # A reset alone moves nothing; then the policies go on, and who drove was stopped.
    run.station.until(lambda shown: shown["stopped"])
    run.station.hold()
    run.station.order("reset-stop")
    run.station.until(lambda shown: not shown["stopped"] and shown["paused"])
    run.station.order("resume")
    assert eventually(lambda: run.does() == ["drives", "asks", "drives"])
    assert actor(run, 1) is actor(run, 3) is Actor.POLICY


def test_a_page_that_is_lost_holds_the_robot_it_drove(run):
    drive(run, 1)
    watch = stopwatch(run)
    run.station.vanish()
    assert eventually(lambda: actor(run, 1) is Actor.HOLD)
    assert watch.took_s < PROMISED_S
    # It stays so, also while another one drives on, until somebody at a page says who goes on.
    assert eventually(lambda: run.does() == ["asks", "drives", "drives"])
    made = len(run.steps(1))
    time.sleep(0.5)
    assert {step.decision.actor for step in run.steps(1)[made:]} <= {Actor.HOLD}


def test_a_robot_that_is_stopped_is_said_to_be_silent_and_the_others_obey(run):
    _, hung = robot(run, 1)
    os.kill(hung, signal.SIGSTOP)
    try:
        assert eventually(lambda: run.words()[0].startswith("not heard of for"))
        run.station.order("emergency-stop")
        assert eventually(lambda: actor(run, 2) is actor(run, 3) is Actor.HOLD)
    finally:
        os.kill(hung, signal.SIGCONT)
    # What was said to it meanwhile is heard as soon as it can hear.
    assert eventually(lambda: actor(run, 1) is Actor.HOLD)
    assert eventually(lambda: run.does() == ["held"] * 3)
    run.cockpit.order(Order.RESET, None, shown=Shown(stops=run.cockpit.state.stops))
    run.cockpit.resume()


def test_a_robot_that_is_killed_costs_its_episode_alone(run, caplog):
    drive(run, 1)
    (killed, process), (other, _) = robot(run, 1), robot(run, 2)
    with caplog.at_level(logging.WARNING):
        os.kill(process, signal.SIGKILL)
        assert eventually(lambda: run.words()[0] == "starting")
    # Who drove it is free, and it is begun anew: by the policy, in the same scene.
    assert run.cockpit.lease.holder is None
    run.station.hold()
    seat = run.cockpit.roster.seats[0]
    assert eventually(lambda: seat.film is not killed and len(run.steps(1)) > 5, START_S)
    again, _ = robot(run, 1)
    assert again.info == killed.info
    assert actor(run, 1) is Actor.POLICY
    assert robot(run, 2)[0] is other
    assert run.does() == ["drives", "drives", "drives"]
    assert not run.ran
    said = [each.getMessage() for each in caplog.records if "was lost" in each.getMessage()]
    assert len(said) == 1
    assert said[0].startswith("robot 1 was lost with exit code -9: ")
    assert said[0].endswith("is begun anew, the others go on")
