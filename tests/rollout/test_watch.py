"""Who is late, and what breaks off a call that hangs; who waits on purpose is neither."""

import signal
import threading
import time

import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.rollout.guard import HUNG, BrokenError, ask
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.rollout.watch import Deadline, Watch, waiting_on_purpose, watched
from sheath_manip.types import Actor, Breakdown, Reason
from tests.cockpit.clock import Clock
from tests.rollout.corridor_episode import Saying, Scripted, run
from tests.toy import CHOICES, Corridor

QUICK = Deadline(share=1.0, hang_s=0.1)


def nothing() -> None:
    pass


@pytest.fixture
def clock() -> Clock:
    return Clock()


def begun(clock: Clock) -> Watch:
    """At 50 Hz half a period is 10 ms."""
    watch = Watch(Deadline(share=0.5, hang_s=1e6), 50.0, nothing, clock)
    watch.begin_step(rests=False)
    return watch


def test_late_is_what_takes_longer_than_its_share_of_the_period(clock):
    with watched(watch := begun(clock)):
        clock.s += 0.0099
        assert not watch.late
        clock.s += 0.0002
        assert watch.late
        watch.begin_step(rests=False)
        assert not watch.late


def test_nobody_is_late_for_what_is_waited_on_purpose(clock):
    with watched(watch := begun(clock)):
        with waiting_on_purpose():
            clock.s += 100.0
        assert not watch.late


def test_nobody_is_late_while_the_robot_rests(clock):
    with watched(watch := begun(clock)):
        watch.begin_step(rests=True)
        clock.s += 1.0
        assert not watch.late


def test_a_clock_that_goes_back_makes_nobody_late(clock):
    with watched(watch := begun(clock)):
        clock.s -= 3600.0
        assert not watch.late


@pytest.mark.parametrize("values", [{"share": 0.0}, {"share": float("nan")}, {"hang_s": -1.0}])
def test_a_deadline_that_is_none_is_refused(values):
    with pytest.raises(ParameterError, match="wanted more than 0"):
        Deadline(**values)


def test_a_call_that_hangs_is_broken_off_once_the_robot_was_told_to_hold():
    told: list[float] = []
    before = signal.getsignal(signal.SIGUSR1)
    began_s = time.monotonic()
    with watched(watch := Watch(QUICK, 50.0, lambda: told.append(time.monotonic()))):
        watch.begin_step(rests=False)
        with pytest.raises(BrokenError, match=r"no answer within 0\.1 s") as broken:
            ask("policy", time.sleep, 60.0)
    assert broken.value.breakdown == Breakdown("policy", HUNG)
    assert len(told) == 1
    assert 0.1 <= told[0] - began_s < 3.0
    assert signal.getsignal(signal.SIGUSR1) == before


def test_what_brings_the_robot_to_rest_may_fail_as_well():
    def fails() -> None:
        raise OSError("no line")

    with watched(watch := Watch(QUICK, 50.0, fails)):
        watch.begin_step(rests=False)
        with pytest.raises(BrokenError):
            ask("policy", time.sleep, 60.0)


def test_on_another_thread_what_runs_in_python_is_broken_off():
    found: list[BrokenError] = []

    def spin() -> None:
        while True:
            time.sleep(0.001)

    def rolls() -> None:
        with watched(watch := Watch(QUICK, 50.0, nothing)):
            watch.begin_step(rests=False)
            try:
                ask("policy", spin)
            except BrokenError as error:
                found.append(error)

    thread = threading.Thread(target=rolls)
    thread.start()
    thread.join(20.0)
    assert [error.breakdown for error in found] == [Breakdown("policy", HUNG)]


def test_who_waits_on_purpose_is_not_broken_off():
    def waits() -> str:
        with waiting_on_purpose():
            time.sleep(0.4)
        return "done"

    with watched(watch := Watch(QUICK, 50.0, nothing)):
        watch.begin_step(rests=False)
        assert ask("gate", waits) == "done"


class Robot(Corridor):
    """Has a driver that can be told to hold."""

    def __init__(self) -> None:
        super().__init__()
        self.holds: list[str] = []

    def hold(self) -> None:
        self.holds.append(threading.current_thread().name)


def hangs_at(step: int):
    def answer(place: int) -> object:
        if place == step:
            time.sleep(60.0)
        return CHOICES[1]

    return answer


def test_a_robot_is_told_to_hold_while_the_policy_hangs_and_goes_on_with_the_expert():
    robot = Robot()
    policy, expert = Saying(hangs_at(4)), Scripted(lambda _: CHOICES[1])
    episode = run(AlwaysPolicy(), policy, expert, environment=robot, deadline=QUICK)
    assert robot.holds == ["watchdog"]
    assert len(episode) == 12
    acted = [step.decision.actor for step in episode.steps]
    # Who hung once is not asked again in this episode.
    assert acted == [Actor.POLICY] * 4 + [Actor.EXPERT] * 8
    assert policy.asked == 5
    assert {step.decision.reason for step in episode.steps[4:]} == {Reason.POLICY_FAILED}


def test_a_run_that_is_paced_is_in_time():
    patient = Deadline(share=20.0, hang_s=0.1)
    policy = Saying(lambda _: CHOICES[1])
    episode = run(
        AlwaysPolicy(), policy, listeners=(Pacing(0.1),), environment=Corridor(3), deadline=patient
    )
    assert all(step.decision.broken == () for step in episode.steps)
