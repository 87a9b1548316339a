"""While a simulation waits for a person it stands still: no step, no acting, and counted apart."""

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, Order, PersonGate, beside_the_policy
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.gates.patient import RequestConfig
from sheath_manip.protocols import Gate
from sheath_manip.rollout.asked import asked_in
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Actor, Episode, Outcome, Reason
from tests.cockpit.clock import Clock
from tests.cockpit.operated_corridor import (
    INFO,
    PERIOD_S,
    STRAIGHT,
    Page,
    Script,
    outside_between,
    reasons,
    take,
)
from tests.toy import Corridor, MiddleKeeper, hold, teleop

pytestmark = pytest.mark.usefixtures("wide_corridor")
GLANCE_S = 0.25
ALARMS = RequestConfig()


class Waiting(Cockpit):
    """Half a second passes in two looks; at the one that `script` names something is done."""

    def __init__(self, clock: Clock, script: Script) -> None:
        super().__init__(teleop(Corridor()).guide, clock)
        self.passing, self.script, self.looks = clock, script, 0

    def rest(self) -> float:
        self.passing.s += GLANCE_S
        self.looks += 1
        self.script.get(self.looks, lambda _: None)(self)
        return GLANCE_S


def run(
    waits: Script,
    steps: Script | None = None,
    alarms=(3, 6),
    requests=ALARMS,
    gate: Gate | None = None,
    **options,
) -> Episode:
    clock = Clock()
    gate = gate or outside_between(*alarms)
    cockpit, environment = Waiting(clock, waits), Corridor()
    return rollout(
        OperatedEnvironment(environment, cockpit),
        INFO,
        PersonGate(gate, cockpit, 50.0, requests=requests, **options),
        rng=np.random.default_rng(0),
        policy=STRAIGHT,
        others=beside_the_policy(
            cockpit,
            teleop(environment),
            hold=hold(environment),
            fallback=MiddleKeeper(environment),
        ),
        listeners=(Page(cockpit, clock, steps or {}),),
    )


def test_a_wait_takes_no_step_and_is_told_with_the_step_after_it():
    episode = run({4: take})
    assert Reason.WAITING not in reasons(episode)
    assert [step.decision.waited_s for step in episode.steps][2:5] == [0.0, 4 * GLANCE_S, 0.0]
    assert reasons(episode)[3] is Reason.PERSON
    assert episode.outcome is Outcome.SUCCESS
    assert len(episode) == 12
    asked = asked_in(episode)
    assert (asked.requests, asked.waited_s) == (1, 4 * GLANCE_S)
    assert asked.turns_s == (pytest.approx(9 * PERIOD_S),)
    assert asked.labels == 9


def test_nobody_comes_and_the_fallback_acts_after_the_wait():
    episode = run({}, wait_s=1.0)
    assert reasons(episode)[3:6] == [Reason.NO_ANSWER] * 3
    assert [step.decision.waited_s for step in episode.steps][3:6] == [1.0, 0.0, 0.0]
    assert asked_in(episode).requests == 1


def test_the_page_may_end_what_waits():
    episode = run({3: lambda page: page.order(Order.SAVE, "page")}, wait_s=100.0)
    assert len(episode) == 4
    assert episode.truncated
    # Nothing has moved.
    np.testing.assert_array_equal(episode.final_state, episode.steps[-1].state)


def test_a_page_that_is_gone_leaves_the_fallback_to_act_after_the_wait():
    episode = run({2: Cockpit.close}, wait_s=0.6)
    # From then on the robot is held step by step, as nobody can come.
    assert reasons(episode)[3:6] == [Reason.WAITING, Reason.WAITING, Reason.WAITING]
    assert len(episode) == 12


def hand_back(page: Cockpit) -> None:
    assert page.order(Order.HAND_BACK, "page")


def test_who_hands_back_early_is_not_asked_again_but_by_an_alarm():
    limits = RequestConfig(turn_s=9.0, quiet_s=9.0)
    episode = run({2: take}, {7: hand_back}, requests=limits)
    assert reasons(episode)[3:7] == [Reason.PERSON] * 4
    assert set(reasons(episode)[7:]) == {Reason.INSIDE}
    assert asked_in(episode).requests == 1


def test_where_nobody_may_be_asked_any_more_the_fallback_acts_and_says_so():
    limits = RequestConfig(an_episode=1)
    episode = run({2: take}, {4: hand_back}, requests=limits)
    assert reasons(episode)[3] is Reason.PERSON
    assert reasons(episode)[4:6] == [Reason.SPARED] * 2
    assert [step.decision.actor for step in episode.steps][4:6] == [Actor.FALLBACK] * 2
    assert set(reasons(episode)[6:]) == {Reason.INSIDE}
    asked = asked_in(episode)
    assert asked.requests == 1
    assert asked.turns_s == (pytest.approx(3 * PERIOD_S),)


def test_an_alarm_under_ones_own_hand_is_no_request():
    limits = RequestConfig(an_episode=1)
    # Taken over unasked, two steps before the gate would have asked.
    episode = run({}, {1: take, 7: hand_back}, (3, 9), requests=limits, wait_s=1.0)
    assert reasons(episode)[1:7] == [Reason.PERSON] * 6
    assert reasons(episode)[7] is Reason.NO_ANSWER
    assert episode.steps[7].decision.waited_s == 1.0


def test_a_gate_that_breaks_down_asks_no_more_often_than_another():
    class Broken(AlwaysPolicy):
        def decide(self, observation, proposal):
            del observation, proposal
            raise ValueError("no gate")

    limits = RequestConfig(an_episode=1)
    episode = run({2: take}, {4: hand_back}, requests=limits, gate=Broken())
    assert asked_in(episode).requests == 1
    assert set(reasons(episode)[4:]) == {Reason.SPARED}


def test_the_page_says_when_the_policy_may_go_on():
    shown = []

    def look(page: Cockpit) -> None:
        shown.append((page.state.taken, page.state.may_go_on))

    run({2: take}, dict.fromkeys(range(1, 12), look), alarms=(3, 7))
    assert shown[:3] == [(False, True)] * 3
    assert set(shown[3:7]) == {(True, False)}
    assert set(shown[7:]) == {(True, True)}
