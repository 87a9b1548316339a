"""Whole episodes on the toy task under the person's gate; orders come at given steps."""

from collections.abc import Callable, Mapping

import numpy as np
import pytest

from sheath_manip.cockpit import (
    Cockpit,
    OperatedEnvironment,
    OperatorInput,
    Order,
    PersonGate,
    beside_the_policy,
)
from sheath_manip.cockpit.lease import LOST_AFTER_S
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, UnattendedError
from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, SupportGate
from sheath_manip.protocols import Expert, Gate
from sheath_manip.rollout.discarding import DiscardedError, until_kept
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Actor, Episode, EpisodeInfo, Observation, Outcome, Purpose, Reason
from sheath_manip.types.samples import samples_from
from tests import toy
from tests.cockpit.test_cockpit import Clock
from tests.judging import ByObservation
from tests.toy import Corridor, MiddleKeeper, hold, teleop
from tools.scripted_person import Absent

INFO = EpisodeInfo("corridor", 3, Purpose.LEARNING, 50.0)
PERIOD_S = 1 / 50.0
LEFT, IDLE = OperatorInput(keys=frozenset({"KeyJ"})), OperatorInput()
Script = Mapping[int, Callable[[Cockpit], object]]
"""by the number of steps done, what is done at the page then"""


@pytest.fixture(autouse=True)
def _wide(monkeypatch) -> None:
    """Nothing is hit, so that an episode is as long as it is."""
    monkeypatch.setattr(toy, "HALF_WIDTH_M", 1e3)


STRAIGHT = Absent(lambda: np.zeros(1, np.float32))


class Page:
    """A listener that plays the page, and lets time pass."""

    def __init__(self, cockpit: Cockpit, clock: Clock, script: Script) -> None:
        self.cockpit, self.clock, self.script = cockpit, clock, script
        self.steps = 0
        self.turns: list[Actor] = []

    def on_fit(self, states) -> None:
        del states

    def on_start(self, environment, info) -> None:
        del environment, info
        self.steps = 0
        self._play()

    def on_step(self, environment, step) -> None:
        del environment
        self.steps += 1
        # A bare gate knows of no person, so its environment stands still instead.
        assert step.decision.actor is self.cockpit.turn or not self.cockpit.gated
        self.turns.append(step.decision.actor)
        self.clock.s += PERIOD_S
        self._play()

    def on_end(self, episode) -> None:
        del episode

    def _play(self) -> None:
        self.script.get(self.steps, lambda _: None)(self.cockpit)


def outside_between(first: int, last: int) -> Gate:
    """A support gate that is outside in those steps."""

    def score(observation: Observation) -> float:
        return -1.0 if first <= observation.features[1] < last else 1.0

    return SupportGate(ByObservation(score), 0.0)


def run(
    script: Script, gate: Gate, steps: int = 12, listeners=(), fallback=None, **options
) -> tuple[Episode, Page]:
    clock = Clock()
    cockpit = Cockpit(teleop(Corridor()).guide, clock)
    environment = Corridor(steps)
    others = beside_the_policy(
        cockpit,
        teleop(environment),
        hold=hold(environment),
        fallback=MiddleKeeper(environment) if fallback is None else fallback,
    )
    page = Page(cockpit, clock, script)
    episode = until_kept(
        lambda *, rng: rollout(
            OperatedEnvironment(environment, cockpit),
            INFO,
            PersonGate(gate, cockpit, 50.0, **{"dead_man": True} | options),
            rng=rng,
            policy=STRAIGHT,
            others=others,
            listeners=(*listeners, page),
        ),
        INFO,
        lambda _: None,
    )
    return episode, page


def reasons(episode: Episode) -> list[Reason]:
    return [step.decision.reason for step in episode.steps]


def take(cockpit: Cockpit, given: OperatorInput = LEFT) -> None:
    assert cockpit.order(Order.TAKE_OVER, "page")
    cockpit.submit_input("page", given)


def test_nobody_comes_so_the_robot_holds_and_then_the_fallback_acts():
    episode, page = run({}, outside_between(3, 9), wait_s=3 * PERIOD_S)
    waited = [Reason.WAITING] * 3
    assert reasons(episode)[3:9] == [*waited, *[Reason.NO_ANSWER] * 3]
    assert set(reasons(episode)[:3] + reasons(episode)[9:]) == {Reason.INSIDE}
    assert page.turns[3:9] == [Actor.HOLD] * 3 + [Actor.FALLBACK] * 3
    held = episode.steps[3]
    assert held.executed == 0
    # Who holds teaches nothing, and the policy's states have nobody to label them.
    taught = [step.label is not None for step in episode.steps]
    assert taught == [False] * 6 + [True] * 3 + [False] * 3
    assert len(samples_from([episode])) == 3
    assert held.decision.score == -1


def test_a_fallback_that_only_stands_in_teaches_nothing():
    fallback = hold(Corridor())
    options = {"fallback": fallback, "fallback_teaches": False, "wait_s": 0.0}
    episode, _ = run({}, outside_between(3, 9), **options)
    assert Reason.WAITING not in reasons(episode)
    assert all(step.label is None for step in episode.steps)


def test_the_person_answers_drives_and_hands_back():
    script = {
        5: take,
        7: lambda page: page.order(Order.HAND_BACK, "page"),
    }
    episode, page = run(script, outside_between(3, 6), wait_s=1.0)
    assert reasons(episode)[3:8] == [*[Reason.WAITING] * 2, *[Reason.PERSON] * 2, Reason.INSIDE]
    assert page.turns[5:7] == [Actor.OPERATOR] * 2
    for step in episode.steps[5:7]:
        assert step.label == step.executed == pytest.approx(-0.3)


def test_who_hands_back_outside_is_asked_again():
    script = {2: take, 3: lambda page: page.order(Order.HAND_BACK, "page")}
    episode, _ = run(script, outside_between(0, 9), wait_s=1.0)
    assert reasons(episode)[:4] == [Reason.WAITING, Reason.WAITING, Reason.PERSON, Reason.WAITING]


def test_a_person_takes_over_at_any_time_and_lets_go_of_the_dead_man():
    script = {4: take, 6: lambda page: page.submit_input("page", IDLE)}
    episode, _ = run(script, AlwaysPolicy())
    assert reasons(episode)[4:] == [*[Reason.PERSON] * 2, *[Reason.IDLE] * 6]
    assert all(step.executed == 0 for step in episode.steps[6:])
    assert sum(step.label is not None for step in episode.steps) == 2


def test_without_a_dead_man_to_press_nothing_is_an_action():
    script = {4: lambda page: take(page, IDLE)}
    episode, _ = run(script, AlwaysPolicy(), dead_man=False)
    assert set(reasons(episode)[4:]) == {Reason.PERSON}
    assert all(step.label is not None for step in episode.steps[4:])


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
        page.order(Order.RESET, "page", seen=page.state.stops)
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
    cockpit.order(Order.RESET, "page", seen=1)
    assert gate.decide(seen, proposal).reason is Reason.EMERGENCY_STOP
    cockpit.order(Order.RESUME, "page")
    assert gate.decide(seen, proposal).actor is Actor.POLICY


@pytest.mark.parametrize(
    ("order", "outcome", "terminated"),
    [
        (Order.SUCCESS, Outcome.SUCCESS, True),
        (Order.FAILURE, Outcome.FAILURE, True),
        (Order.SAVE, Outcome.TIME_LIMIT, False),
    ],
)
def test_a_person_ends_the_episode(order, outcome, terminated):
    episode, _ = run({4: lambda page: page.order(order, "page")}, AlwaysPolicy())
    assert len(episode) == 5
    assert (episode.outcome, episode.terminated) == (outcome, terminated)
    assert episode.truncated is not terminated


def test_a_discarded_episode_leaves_nothing_and_is_run_again(tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    discarded = []

    def once(page: Cockpit) -> None:
        if not discarded:
            discarded.append(page.order(Order.DISCARD, "page"))

    episode, page = run({4: once}, AlwaysPolicy(), listeners=(Recorder(store),))
    assert discarded == [True]
    assert len(store.names()) == 1
    assert len(page.turns) == 4 + len(episode)
    assert len(episode) == 12


def test_a_simulation_that_cannot_hold_stands_still():
    """Nothing is recorded while it does; the wait is one of the clock then."""

    class Passing(Clock):
        """Half a second at each look."""

        def __call__(self) -> float:
            self.s += 0.25
            return self.s

    cockpit = Cockpit(teleop(Corridor()).guide, Passing())
    environment = Corridor()
    gate = PersonGate(outside_between(3, 6), cockpit, 50.0, wait_s=2.0, can_hold=False)
    episode = rollout(
        OperatedEnvironment(environment, cockpit),
        INFO,
        gate,
        rng=np.random.default_rng(0),
        policy=STRAIGHT,
        others=without_hold(cockpit, environment),
    )
    assert reasons(episode)[3:6] == [Reason.NO_ANSWER] * 3
    assert len(episode) == 12


def without_hold(cockpit: Cockpit, environment: Corridor) -> Mapping[Actor, Expert]:
    """Who may act where the simulation cannot hold: what holds it is never asked."""
    scripted = MiddleKeeper(environment)
    return beside_the_policy(cockpit, teleop(environment), hold=scripted, fallback=scripted)


class Impatient(Cockpit):
    """Does `script` at each look, instead of waiting for news."""

    script: Callable[[Cockpit], object] = staticmethod(lambda _: None)

    def rest(self) -> float:
        self.script(self)
        return 0.01


def cannot_hold(
    gate: Gate, before: Callable[[Cockpit], object], meanwhile, wait_s=0.0, wrap=True
) -> Episode:
    """A run of a simulation that cannot hold; `before` is done once it goes, `meanwhile` then."""
    cockpit = Impatient(teleop(Corridor()).guide, Clock())
    cockpit.script = meanwhile
    environment = Corridor()
    person = PersonGate(gate, cockpit, 50.0, wait_s=wait_s, can_hold=False, dead_man=False)
    try:
        return rollout(
            OperatedEnvironment(environment, cockpit),
            INFO,
            person if wrap else gate,
            rng=np.random.default_rng(0),
            policy=STRAIGHT,
            others=without_hold(cockpit, environment),
            listeners=(Page(cockpit, Clock(), {4: before}),),
        )
    finally:
        assert environment.done == 4 or not cockpit.state.stopped


@pytest.mark.parametrize("wrap", [True, False], ids=["person's gate", "bare gate"])
@pytest.mark.parametrize(
    ("before", "why"),
    [
        (lambda page: page.order(Order.STOP, "page"), "emergency stop"),
        (lambda page: (take(page), page.leave("page")), "lost"),
    ],
)
def test_what_cannot_hold_ends_the_run_where_nobody_is_left_to_say_how_to_go_on(before, why, wrap):
    with pytest.raises(UnattendedError, match=why):
        cannot_hold(AlwaysPolicy(), before, Cockpit.close, wrap=wrap)


@pytest.mark.parametrize("wrap", [True, False], ids=["person's gate", "bare gate"])
def test_what_cannot_hold_takes_no_last_step_after_a_stop(wrap):
    episode = cannot_hold(
        AlwaysPolicy(),
        lambda page: page.order(Order.STOP, "page"),
        lambda page: page.order(Order.SAVE, "page"),
        wrap=wrap,
    )
    assert episode.truncated
    assert not episode.terminated
    np.testing.assert_array_equal(episode.final_state, episode.steps[-1].state)


@pytest.mark.parametrize("wrap", [True, False], ids=["person's gate", "bare gate"])
def test_what_cannot_hold_goes_on_after_reset_and_resume(wrap):
    def reset(page: Cockpit) -> None:
        page.order(Order.RESET, "page", seen=page.state.stops)
        page.order(Order.RESUME, "page", seen=page.state.stops)

    episode = cannot_hold(
        AlwaysPolicy(), lambda page: page.order(Order.STOP, "page"), reset, wrap=wrap
    )
    assert len(episode) == 12
    assert episode.outcome is Outcome.SUCCESS


@pytest.mark.parametrize(("wait_s", "ends"), [(100.0, False), (float("inf"), True)])
def test_a_wait_that_is_in_vain_ends(wait_s, ends):
    """The fallback acts at once where it was to act anyway; where it never was, the run ends."""
    if ends:
        with pytest.raises(UnattendedError, match="as long as it takes"):
            cannot_hold(AlwaysExpert(), lambda _: None, Cockpit.close, wait_s)
    else:
        episode = cannot_hold(AlwaysExpert(), lambda _: None, Cockpit.close, wait_s)
        assert set(reasons(episode)) == {Reason.NO_ANSWER}


def test_a_demonstration_by_hand_is_the_persons():
    episode, _ = run({0: take}, AlwaysExpert(), wait_s=float("inf"))
    assert set(reasons(episode)) == {Reason.PERSON}
    assert all(step.label is not None for step in episode.steps[:-1])


def test_discarding_ends_the_episode_at_its_next_step():
    cockpit = Cockpit(teleop(Corridor()).guide)
    environment = OperatedEnvironment(Corridor(), cockpit)
    environment.reset(0)
    cockpit.order(Order.DISCARD, "page")
    cockpit.now()
    with pytest.raises(DiscardedError):
        environment.step(np.zeros(1, np.float32))


def test_a_wait_below_zero_is_refused():
    with pytest.raises(ParameterError, match="wait_s is -1"):
        PersonGate(AlwaysExpert(), Cockpit(), 50.0, wait_s=-1)
