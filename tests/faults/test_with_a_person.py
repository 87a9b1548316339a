"""Whatever fails with a person beside it, the person is asked, and a stop holds the robot."""

from typing import Any

import numpy as np
import pytest

from sheath_manip.cockpit import Order
from sheath_manip.exceptions import AttemptError
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.types import Actor, Breakdown, Reason
from tests import toy
from tests.cockpit import operated_corridor
from tests.cockpit.operated_corridor import run, take
from tests.faults.parts import Faulty, Straight
from tests.faults.ways import NO_ACTIONS, NO_DECISIONS, NO_PROPOSALS, RAISING, answering


@pytest.fixture(autouse=True)
def wide_corridor(monkeypatch) -> None:
    """Nothing is hit, so that an episode is as long as it is."""
    monkeypatch.setattr(toy, "HALF_WIDTH_M", 1e3)


FEW = ("ValueError", "MemoryError", "endless recursion", "no words")
POLICIES = {name: RAISING[name] for name in FEW} | {
    name: answering(NO_PROPOSALS[name]) for name in ("of NaN", "nothing", "latents of NaN")
}
GATES = {name: RAISING[name] for name in FEW} | {
    name: answering(NO_DECISIONS[name]) for name in ("None", "a complex score", "an unknown actor")
}


def stop(cockpit) -> None:
    assert cockpit.order(Order.STOP, "page")


@pytest.mark.parametrize("way", POLICIES.values(), ids=POLICIES)
@pytest.mark.parametrize("stopped", [False, True])
def test_where_the_policy_fails_a_person_is_asked(way, stopped, monkeypatch):
    monkeypatch.setattr(operated_corridor, "STRAIGHT", Faulty(Straight(), "propose", way, 2, 99))
    episode, _ = run({4: stop} if stopped else {}, AlwaysPolicy(), wait_s=1e9)
    decisions = [step.decision for step in episode.steps]
    assert all(decision.broken[0].who == "policy" for decision in decisions[2:])
    assert {decision.actor for decision in decisions[2:]} == {Actor.HOLD}
    wanted = [Reason.WAITING] * 2 + [Reason.EMERGENCY_STOP if stopped else Reason.WAITING] * 8
    assert [decision.reason for decision in decisions[2:]] == wanted
    for step in episode.steps[2:]:
        np.testing.assert_array_equal(step.executed, [0.0])


@pytest.mark.parametrize("way", GATES.values(), ids=GATES)
@pytest.mark.parametrize("stopped", [False, True])
def test_where_the_gate_fails_a_person_is_asked(way, stopped):
    gate: Any = Faulty(AlwaysPolicy(), "decide", way, 2, 99)
    episode, _ = run({4: stop} if stopped else {}, gate, wait_s=1e9)
    decisions = [step.decision for step in episode.steps]
    assert all(decision.broken[0].who == "gate" for decision in decisions[2:])
    assert {decision.actor for decision in decisions[2:]} == {Actor.HOLD}
    assert (decisions[-1].reason is Reason.EMERGENCY_STOP) == stopped


def test_a_person_drives_on_whatever_the_gate_does():
    gate: Any = Faulty(AlwaysPolicy(), "decide", RAISING["ValueError"], 0, 99)
    episode, _ = run({2: take}, gate, wait_s=1e9)
    assert {step.decision.actor for step in episode.steps[2:]} == {Actor.OPERATOR}


@pytest.mark.parametrize("answer", ["NaN", "out of bounds", "None", "text"])
def test_where_what_the_person_holds_fails_the_robot_holds_and_the_person_may_go_on(
    answer, monkeypatch, dropped_listeners
):
    beside = operated_corridor.beside_the_policy

    def faulty(*arguments, **options):
        others: dict[Actor, Any] = dict(beside(*arguments, **options))
        way = answering(NO_ACTIONS[answer])
        others[Actor.OPERATOR] = Faulty(others[Actor.OPERATOR], "act", way, 3, 2)
        return others

    monkeypatch.setattr(operated_corridor, "beside_the_policy", faulty)
    script = {0: take}
    with_hold = run(script, AlwaysPolicy(), held_by_loop=True)[0]
    # This page wants to be told of each turn by the gate, which did not know of this one.
    dropped_listeners.clear()
    actors = [step.decision.actor for step in with_hold.steps]
    assert actors == [Actor.OPERATOR] * 3 + [Actor.HOLD] * 2 + [Actor.OPERATOR] * 7
    broken = with_hold.steps[3].decision
    assert broken.reason is Reason.ACTOR_FAILED
    assert broken.broken == (Breakdown("operator", "ActionError"),)
    with pytest.raises(AttemptError, match="operator broke down"):
        run(script, AlwaysPolicy())
