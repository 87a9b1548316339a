"""A lost person or a stop lets the robot hold until somebody says how to go on."""

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, Order, PersonGate, beside_the_policy
from sheath_manip.cockpit.lease import LOST_AFTER_S
from sheath_manip.cockpit.shown import Shown
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.protocols import Gate
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Actor, Outcome, Reason
from tests.cockpit.clock import Clock
from tests.cockpit.operated_corridor import INFO, PERIOD_S, STRAIGHT, Page, reasons, run, take
from tests.toy import Corridor, MiddleKeeper, hold, teleop

pytestmark = pytest.mark.usefixtures("wide_corridor")


def test_after_a_lost_heartbeat_the_robot_holds_and_nobody_acts_of_itself():
    episode, page = run({2: take}, AlwaysPolicy(), steps=400, wait_s=1.0)
    drove = page.turns.count(Actor.OPERATOR)
    assert drove * PERIOD_S == pytest.approx(LOST_AFTER_S, abs=2 * PERIOD_S)
    assert set(page.turns[2 + drove :]) == {Actor.HOLD}
    assert set(reasons(episode)[2 + drove :]) == {Reason.WAITING}
    assert episode.outcome is Outcome.SUCCESS


def test_after_a_loss_the_next_episode_holds_too_until_somebody_says_who_goes_on():
    clock = Clock()
    cockpit = Cockpit(teleop(Corridor()).guide, clock)
    environment = Corridor()
    others = beside_the_policy(
        cockpit, teleop(environment), hold=hold(environment), fallback=MiddleKeeper(environment)
    )
    page = Page(cockpit, clock, {4: lambda page: page.leave("page")})
    take(cockpit)

    def episode(gate: Gate) -> list[Actor]:
        page.turns.clear()
        rollout(
            OperatedEnvironment(environment, cockpit),
            INFO,
            gate,
            rng=np.random.default_rng(0),
            policy=STRAIGHT,
            others=others,
            listeners=(page,),
        )
        return list(page.turns)

    gate = PersonGate(AlwaysPolicy(), cockpit, 50.0, wait_s=0.0)
    assert episode(gate) == [Actor.OPERATOR] * 4 + [Actor.HOLD] * 8
    page.script = {5: lambda page: page.order(Order.HAND_BACK, "another page")}
    assert episode(gate) == [Actor.HOLD] * 5 + [Actor.POLICY] * 7


def test_the_stop_acts_on_the_next_step_and_needs_a_reset_and_a_new_takeover():
    def reset(page: Cockpit) -> None:
        page.order(Order.RESET, "page", shown=Shown(stops=page.state.stops))
        page.order(Order.RESUME, "page")

    script = {3: take, 5: lambda page: page.order(Order.STOP, "a watcher"), 9: reset, 10: take}
    episode, _ = run(script, AlwaysPolicy(), wait_s=0.0)
    assert reasons(episode)[3:5] == [Reason.PERSON] * 2
    assert reasons(episode)[5:9] == [Reason.EMERGENCY_STOP] * 4
    # Neither the policy nor the key that is still held goes on by itself.
    assert reasons(episode)[9] is Reason.WAITING
    assert reasons(episode)[10] is Reason.PERSON
    assert all(step.label is None for step in episode.steps[5:9])


def test_a_stop_and_its_reset_between_two_looks_of_the_loop_still_halt_it():
    """No motion until somebody resumes, though no step ever saw the stop."""
    cockpit = Cockpit(teleop(Corridor()).guide, Clock())
    gate = PersonGate(AlwaysPolicy(), cockpit, 50.0)
    seen = Corridor().reset(0)
    proposal = STRAIGHT.propose(seen.alone)
    assert gate.decide(seen, proposal).actor is Actor.POLICY
    cockpit.wait()
    cockpit.order(Order.STOP, "page")
    cockpit.order(Order.RESET, "page", shown=Shown(stops=1))
    assert gate.decide(seen, proposal).reason is Reason.EMERGENCY_STOP
    cockpit.order(Order.RESUME, "page")
    assert gate.decide(seen, proposal).actor is Actor.POLICY
