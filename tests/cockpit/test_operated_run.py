"""Whole episodes on the toy task under the person's gate: who acts, what teaches, how it ends."""

from concurrent.futures import ThreadPoolExecutor, wait

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, Order, PersonGate
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.gates import AlwaysExpert, AlwaysPolicy
from sheath_manip.rollout.discarding import DiscardedError
from sheath_manip.types import Actor, Outcome, Reason
from sheath_manip.types.samples import samples_from
from tests.cockpit.clock import Clock
from tests.cockpit.operated_corridor import (
    IDLE,
    LEFT,
    PERIOD_S,
    outside_between,
    reasons,
    run,
    take,
)
from tests.toy import Corridor, hold, teleop
from tests.waiting import DEADLINE_S

pytestmark = pytest.mark.usefixtures("wide_corridor")


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
    script = {4: take, 6: lambda page: page.submit_input("page", IDLE)}
    episode, _ = run(script, AlwaysPolicy(), dead_man=False)
    assert set(reasons(episode)[4:]) == {Reason.PERSON}
    assert all(step.label is not None for step in episode.steps[4:])


def test_a_turn_begins_with_the_first_key_also_without_a_dead_man():
    """Who has just taken over a car has not got hold of anything yet."""
    script = {4: lambda page: take(page, IDLE), 7: lambda page: page.submit_input("page", LEFT)}
    episode, _ = run(script, AlwaysPolicy(), dead_man=False)
    assert set(reasons(episode)[4:7]) == {Reason.IDLE}
    assert set(reasons(episode)[7:]) == {Reason.PERSON}


def test_after_a_silence_a_car_does_not_set_off_by_itself():
    script = {
        2: take,
        4: lambda page: page.silence("page"),
        6: lambda page: page.submit_input("page", IDLE),
        8: lambda page: page.submit_input("page", LEFT),
        9: lambda page: page.submit_input("page", IDLE),
    }
    episode, _ = run(script, AlwaysPolicy(), dead_man=False)
    assert reasons(episode)[2:4] == [Reason.PERSON] * 2
    assert reasons(episode)[4:6] == [Reason.WAITING] * 2
    assert reasons(episode)[6:8] == [Reason.IDLE] * 2
    assert set(reasons(episode)[8:]) == {Reason.PERSON}


def test_the_next_episode_begins_with_the_next_key_of_who_drives_on():
    cockpit = Cockpit(teleop(Corridor()).guide, Clock())
    take(cockpit)
    assert cockpit.now().touched
    cockpit.begin_episode()
    assert not cockpit.now().touched
    cockpit.submit_input("page", LEFT)
    assert cockpit.now().touched


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


def test_a_demonstration_by_hand_is_the_persons():
    episode, _ = run({0: take}, AlwaysExpert(), wait_s=float("inf"))
    assert set(reasons(episode)) == {Reason.PERSON}
    assert all(step.label is not None for step in episode.steps[:-1])


def test_discarding_ends_the_episode_at_its_next_step():
    cockpit = Cockpit(teleop(Corridor()).guide, undo_s=0.0)
    environment = OperatedEnvironment(Corridor(), cockpit)
    environment.reset(0)
    cockpit.order(Order.DISCARD, "page")
    cockpit.now()
    with pytest.raises(DiscardedError):
        environment.step(np.zeros(1, np.float32))


def test_an_episode_does_not_end_by_itself_while_its_discard_may_be_called_off():
    cockpit = Cockpit(teleop(Corridor()).guide, undo_s=60.0)
    environment = OperatedEnvironment(Corridor(1), cockpit)
    environment.reset(0)
    cockpit.order(Order.DISCARD, "page")
    with ThreadPoolExecutor(1) as pool:
        step = pool.submit(environment.step, np.zeros(1, np.float32))
        assert not wait([step], 0.1).done
        cockpit.order(Order.CALL_OFF, "page")
        assert step.result(DEADLINE_S).terminated
    # Nobody is left to call anything off.
    environment.reset(0)
    cockpit.order(Order.DISCARD, "page")
    cockpit.close()
    with pytest.raises(DiscardedError):
        environment.step(np.zeros(1, np.float32))


def test_a_wait_below_zero_is_refused():
    with pytest.raises(ParameterError, match="wait_s is -1"):
        PersonGate(AlwaysExpert(), Cockpit(), 50.0, wait_s=-1)
