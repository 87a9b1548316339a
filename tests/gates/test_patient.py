"""A gate that asks seldom: alarms always count, and what is spared is the hand-back."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.patient import PatientGate, RequestConfig
from sheath_manip.gates.support import SupportGate
from sheath_manip.types import Actor, Observation, Proposal, Reason
from tests.judging import ByObservation

RATE_HZ = 10.0
PROPOSED = Proposal(np.zeros((1, 1), np.float32))


def driven(alarms: list[int], steps: int, **limits) -> list[tuple[Actor, Reason]]:
    """Who acts in each step where the score is low in those of `alarms`."""
    judge = ByObservation(lambda seen: -1.0 if seen.features[0] in alarms else 1.0)
    gate = PatientGate(SupportGate(judge, 0.0), RequestConfig(**limits))
    gate.reset(np.random.default_rng(0))
    decisions = []
    for step in range(steps):
        seen = Observation({}, np.array([step], np.float32), step / RATE_HZ)
        decisions.append(gate.decide(seen, PROPOSED))
    return [(decision.actor, decision.reason) for decision in decisions]


def expert_steps(decisions: list[tuple[Actor, Reason]]) -> list[int]:
    return [step for step, (actor, _) in enumerate(decisions) if actor is Actor.EXPERT]


def test_without_limits_it_is_the_gate_itself() -> None:
    assert expert_steps(driven([2, 3, 7], 10)) == [2, 3, 7]
    assert not RequestConfig().limits


def test_a_turn_lasts_as_long_as_it_must() -> None:
    decisions = driven([2], 12, turn_s=0.5)
    assert expert_steps(decisions) == [2, 3, 4, 5, 6]
    assert [reason for _, reason in decisions[2:5]] == [Reason.OUTSIDE, Reason.HOLD, Reason.HOLD]


def test_alarms_close_together_are_one_request() -> None:
    # Quiet for .3 s: the alarm of step 4 comes before that, the one of step 9 after it.
    assert expert_steps(driven([2, 4, 9], 14, quiet_s=0.3)) == [2, 3, 4, 5, 6, 7, 9, 10, 11, 12]


def test_after_the_last_request_of_an_episode_the_expert_drives_on() -> None:
    decisions = driven([1, 4], 10, an_episode=2)
    assert expert_steps(decisions) == [1, 4, 5, 6, 7, 8, 9]
    assert {reason for _, reason in decisions[5:]} == {Reason.SPARED}


def test_who_drives_already_is_asked_nothing() -> None:
    judge = ByObservation(lambda seen: -1.0 if seen.features[0] in (2, 4, 8) else 1.0)
    gate = PatientGate(SupportGate(judge, 0.0), RequestConfig(an_episode=1))
    gate.reset(np.random.default_rng(0))
    reasons = []
    for step in range(12):
        gate.counts = step >= 6
        if step == 6:
            gate.release()
        seen = Observation({}, np.array([step], np.float32), step / RATE_HZ)
        reasons.append(gate.decide(seen, PROPOSED).reason)
    # The one request that there may be is that of step 8, after which the expert drives on.
    assert reasons[8] is Reason.OUTSIDE
    assert set(reasons[9:]) == {Reason.SPARED}


def test_after_the_last_request_of_a_minute_it_drives_until_another_may_come() -> None:
    decisions = driven([10, 20], 700, a_minute=2)
    assert expert_steps(decisions) == [10, *range(20, 610)]


@pytest.mark.parametrize("seed", range(5))
def test_no_alarm_is_ever_left_to_the_policy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    alarms = [int(step) for step in np.flatnonzero(rng.random(3000) < 0.02)]
    decisions = driven(alarms, 3000, turn_s=1.0, quiet_s=0.5, a_minute=4)
    driving = set(expert_steps(decisions))
    assert set(alarms) <= driving
    begun = [step for step in sorted(driving) if step - 1 not in driving]
    assert len(begun) >= 4
    assert max(sum(at <= other < at + 600 for other in begun) for at in begun) <= 4


def test_requests_of_one_episode_do_not_count_in_the_next() -> None:
    gate = PatientGate(
        SupportGate(ByObservation(lambda seen: float(seen.features[0])), 0.0),
        RequestConfig(an_episode=1),
    )
    for _ in range(2):
        gate.reset(np.random.default_rng(0))
        acted = [
            gate.decide(Observation({}, np.array([score], np.float32), step / RATE_HZ), PROPOSED)
            for step, score in enumerate((1.0, -1.0, 1.0))
        ]
        assert [each.actor is Actor.EXPERT for each in acted] == [False, True, True]


def step_by_step(gate: PatientGate, scores: list[float], first: int = 0) -> list:
    """Decide one step each, from step `first` of an episode on."""
    return [
        gate.decide(
            Observation({}, np.array([score], np.float32), (first + step) / RATE_HZ), PROPOSED
        )
        for step, score in enumerate(scores)
    ]


def by_score(**limits) -> SupportGate:
    return SupportGate(ByObservation(lambda seen: float(seen.features[0])), 0.0, **limits)


def test_in_a_session_a_minute_does_not_end_with_the_episode():
    gate = PatientGate(by_score(), RequestConfig(a_minute=2), session=True)
    actors = []
    for _ in range(3):
        gate.reset(np.random.default_rng(0))
        actors.append([each.actor for each in step_by_step(gate, [1.0, -1.0, 1.0, 1.0])])
    policy, expert = Actor.POLICY, Actor.EXPERT
    assert actors[0] == [policy, expert, policy, policy]
    # The second request is the last of the minute: its turn goes on, in the next episode as well.
    assert actors[1:] == [[policy, expert, expert, expert], [expert] * 4]


def test_who_hands_back_early_is_left_alone_until_the_next_alarm():
    gate = PatientGate(by_score(minimum_hold_steps=9), RequestConfig(turn_s=9.0, an_episode=2))
    gate.reset(np.random.default_rng(0))
    first = step_by_step(gate, [-1.0, 1.0])
    assert [each.reason for each in first] == [Reason.OUTSIDE, Reason.HOLD]
    gate.release()
    calm, alarm = step_by_step(gate, [1.0, -1.0], first=2)
    assert (calm.actor, calm.query, calm.reason) == (Actor.POLICY, False, Reason.PERSON)
    assert (alarm.actor, alarm.reason) == (Actor.EXPERT, Reason.OUTSIDE)


def test_an_alarm_beyond_the_last_request_is_never_left_to_the_policy():
    gate = PatientGate(by_score(), RequestConfig(an_episode=1))
    gate.reset(np.random.default_rng(0))
    step_by_step(gate, [-1.0])
    gate.release()
    calm, alarm, after = step_by_step(gate, [1.0, -1.0, 1.0], first=1)
    assert calm.actor is Actor.POLICY
    # Nobody is to be asked, and somebody has to act.
    assert (alarm.actor, alarm.reason) == (Actor.EXPERT, Reason.SPARED)
    assert after.actor is Actor.POLICY


def test_a_config_keeps_them_and_old_ones_have_none() -> None:
    config = GateConfig(requests=RequestConfig(turn_s=2.0, a_minute=4))
    assert GateConfig.from_described(config.described()) == config
    described = config.described()
    del described["requests"]
    assert GateConfig.from_described(described).requests == RequestConfig()
    for settings in ({"turn_s": -1.0}, {"a_minute": -1}, {"quiet_s": float("nan")}):
        with pytest.raises(ParameterError, match="wanted at least 0"):
            replace(RequestConfig(), **settings)
