"""A simulated person at the cockpit: he answers late, is asked seldom, and loses nothing by it."""

import numpy as np
import pytest

from sheath_manip.cockpit.answered import AnsweredCockpit, AnsweredDriver, AnsweredGate
from sheath_manip.cockpit.gate import PersonGate
from sheath_manip.gates.patient import FOR_PEOPLE, RequestConfig
from sheath_manip.gates.support import SupportGate
from sheath_manip.metrics import runs_of
from sheath_manip.rollout.asked import asked_in
from sheath_manip.rollout.request import Crew, EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.rollout.simulated_operator import OperatorConfig, SimulatedOperator
from sheath_manip.types import Actor, GateDecision, Observation, Proposal, Reason
from tests.cockpit.operated_corridor import INFO, STRAIGHT, outside_between
from tests.judging import ByObservation
from tests.toy import CORRIDOR

RATE_HZ = 10.0
PROPOSED = Proposal(np.zeros((1, 1), np.float32))
MINUTES = 4
USUAL = OperatorConfig()


def decided(
    alarms: np.ndarray, episode_steps: int = 10**6, operator=USUAL, **settings
) -> list[GateDecision]:
    """What becomes of alarms in those steps, over episodes of so many steps each."""
    judge = ByObservation(lambda seen: -1.0 if alarms[int(seen.features[0])] else 1.0)
    cockpit = AnsweredCockpit(SimulatedOperator(operator))
    gate = AnsweredGate(PersonGate(SupportGate(judge, 0.0), cockpit, RATE_HZ, **settings), cockpit)
    found = []
    for step in range(len(alarms)):
        if step % episode_steps == 0:
            gate.reset(np.random.default_rng(step))
        seen = Observation({}, np.array([step], np.float32), step % episode_steps / RATE_HZ)
        found.append(gate.decide(seen, PROPOSED))
    return found


def chatter(seed: int, share: float = 0.05) -> np.ndarray:
    """Single steps of alarm, as today's gates have them: 30 a minute at 10 Hz."""
    return np.random.default_rng(seed).random(round(MINUTES * 60 * RATE_HZ)) < share


@pytest.mark.parametrize("episode_steps", [10**6, 60])
def test_alarms_of_thirty_a_minute_become_three_requests_and_turns_to_live_with(episode_steps):
    alarms = chatter(0)
    assert len(runs_of(alarms)) > 25 * MINUTES
    decisions = decided(alarms, episode_steps)
    driven = np.array([each.actor is Actor.OPERATOR for each in decisions])
    asked = np.flatnonzero([each.waited_s > 0 for each in decisions])
    # Three in any minute, also where an episode lasts but six seconds.
    assert 3 <= len(asked) <= 4 * MINUTES
    assert all(np.sum((asked >= at) & (asked < at + 60 * RATE_HZ)) <= 3 for at in asked)
    turns = [stop - first for first, stop in runs_of(driven)]
    assert np.median(turns) >= RATE_HZ
    # No alarm is left to the policy, nor to anybody else.
    assert driven[alarms].all()


def test_he_is_waited_for_as_long_as_he_needs_and_no_step_is_made():
    alarms = np.zeros(200, bool)
    alarms[[50, 53]] = True
    quick = OperatorConfig(reaction_s=1.2, reaction_spread_s=0.0)
    decisions = decided(alarms, operator=quick)
    assert Reason.WAITING not in {each.reason for each in decisions}
    waited = [(step, each.waited_s) for step, each in enumerate(decisions) if each.waited_s]
    assert waited == [(50, pytest.approx(1.2, abs=0.05))]
    driven = [step for step, each in enumerate(decisions) if each.actor is Actor.OPERATOR]
    # Quiet for a second since the last alarm, at least 2 s in all, and then his reaction.
    assert driven == list(range(50, driven[-1] + 1))
    assert driven[-1] - 50 == pytest.approx(RATE_HZ * (2.0 + 1.2), abs=2)


def test_what_he_overlooks_the_fallback_answers_after_the_wait():
    alarms = np.zeros(100, bool)
    alarms[10:15] = True
    blind = OperatorConfig(overlooked=1.0)
    decisions = decided(alarms, operator=blind, wait_s=3.0)
    assert decisions[10].waited_s == pytest.approx(3.0, abs=0.05)
    assert [each.actor for each in decisions[10:15]] == [Actor.FALLBACK] * 5
    assert Actor.OPERATOR not in {each.actor for each in decisions}


class Doubtful:
    """A driver of the toy task whose gate is outside in three steps."""

    def crew(self, task, environment) -> Crew:
        return Crew(outside_between(3, 6), STRAIGHT, task.make_expert(environment))


def test_whole_episodes_are_the_same_again_and_his_labels_are_the_scripts(wide_corridor):
    del wide_corridor
    driver = AnsweredDriver(Doubtful(), requests=RequestConfig())
    episodes = []
    for _ in range(2):
        # Each before a person who has just sat down.
        with SerialExecutor() as executor:
            episodes += executor.map([EpisodeRequest(CORRIDOR, INFO, driver)])
    first, again = ([step.decision for step in episode.steps] for episode in episodes)
    assert first == again
    for episode in episodes:
        assert {step.decision.reason for step in episode.steps} == {Reason.INSIDE, Reason.PERSON}
        driven = [step for step in episode.steps if step.decision.actor is Actor.OPERATOR]
        assert all(step.label is not None for step in driven)
    assert first[3].waited_s > 0.5
    assert [each.waited_s for each in first][4:] == [0.0] * 8


@pytest.mark.usefixtures("wide_corridor")
def test_who_drives_when_an_episode_ends_drives_on_in_the_next():
    driver = AnsweredDriver(Doubtful(), requests=RequestConfig())
    with SerialExecutor() as executor:
        _, after = executor.map([EpisodeRequest(CORRIDOR, INFO, driver)] * 2)
    assert after.steps[0].decision.actor is Actor.OPERATOR
    assert asked_in(after).requests == 0


def test_the_defaults_are_what_was_promised():
    assert 0 < FOR_PEOPLE.a_minute <= 3
    assert FOR_PEOPLE.turn_s >= 1.0
    assert OperatorConfig().reaction_s == 1.2
