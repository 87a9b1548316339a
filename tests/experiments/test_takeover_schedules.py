"""What calls the expert as often as a gate does, and where a gate that was chosen stands."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.takeovers.choosing import Rung, at_burden
from sheath_manip.experiments.takeovers.figures_of_trials import Weighed, found, interval
from sheath_manip.experiments.takeovers.oracle import last_saving_step
from sheath_manip.experiments.takeovers.plan import FRESH, TUNING, Quota, TakeoversPlan
from sheath_manip.experiments.takeovers.schedules import SCHEDULES, Gated
from sheath_manip.experiments.takeovers.trial import Trial, mean_share, mean_takeovers
from sheath_manip.gates.scheduled import ScheduledTakeovers
from sheath_manip.types import Actor, Observation, Outcome, Proposal

SEEN = Observation({}, np.zeros(1, np.float32), 0.0)
PROPOSAL = Proposal(np.zeros((1, 1), np.float32))


def trial(*turns: tuple[int, int], steps: int = 100, failing: bool = True, seed: int = 0) -> Trial:
    return Trial(seed, failing, Outcome.SUCCESS, steps, turns)


GATE = [trial((10, 10), (60, 20)), trial((30, 10)), trial(), trial((5, 50), failing=False)]
ALONE_STEPS = [70, 60, 80, 100]
GATED = Gated(GATE, ALONE_STEPS)


def drawn(name: str, draws: int = 400) -> list:
    return [
        SCHEDULES[name](GATED, index, np.random.default_rng(100 * draw + index))
        for draw in range(draws)
        for index in range(3)
    ]


def steps_within(turns, steps: int = 100) -> int:
    return sum(max(0, min(start + count, steps) - start) for start, count in turns)


def begun_in_the_policys_time(turns, steps: int) -> int:
    """How many turns begin within so many steps that are not the expert's."""
    before = np.cumsum([0, *(count for _, count in turns)])[:-1]
    return sum(start - expert < steps for (start, _), expert in zip(turns, before, strict=True))


@pytest.mark.parametrize("name", ["random-steps", "every-kth-step"])
def test_a_schedule_asks_as_much_as_the_gate_does(name):
    share = np.mean([steps_within(turns) for turns in drawn(name)]) / 100
    assert share == pytest.approx(mean_share(GATE[:3]), rel=0.15)


def test_each_scene_has_as_many_blocks_as_the_gate_has_in_one_within_the_policys_own_time():
    turns = drawn("random-blocks")
    for place in range(3):
        here = turns[place::3]
        assert np.mean([len(each) for each in here]) == pytest.approx(
            mean_takeovers(GATE[:3]), rel=0.1
        )
        assert all(
            begun_in_the_policys_time(each, ALONE_STEPS[place]) == len(each) for each in here
        )
    assert {count for each in turns for _, count in each} == {10, 20}


def test_its_own_turns_come_at_random_times_and_none_overlap():
    for turns in drawn("own-at-random-times")[::3]:
        assert sorted(count for _, count in turns) == [10, 20]
        (first, count), (second, _) = turns
        assert first >= 0
        assert first + count < second
        assert begun_in_the_policys_time(turns, ALONE_STEPS[0]) == 2
    assert len(set(drawn("own-at-random-times")[::3])) > 100


def test_a_scene_without_a_step_of_the_policys_begins_with_the_expert():
    gated = Gated([trial((0, 100))], [0])
    turns = SCHEDULES["random-blocks"](gated, 0, np.random.default_rng(0))
    assert turns == ((0, 100),)


def test_another_scenes_turns_are_never_its_own():
    for index, turns in enumerate(drawn("another-scenes")):
        assert turns in [each.turns for place, each in enumerate(GATE) if place != index % 3]


def test_a_gate_that_never_took_over_gives_empty_schedules():
    for schedule in SCHEDULES.values():
        assert schedule(Gated([trial(), trial()], [50, 50]), 0, np.random.default_rng(0)) == ()


def test_the_scheduled_expert_acts_in_its_steps_alone():
    gate = ScheduledTakeovers([(2, 2), (5, 1)], first_step=1)
    gate.reset(np.random.default_rng(0))
    actors = [gate.decide(SEEN, PROPOSAL).actor for _ in range(1, 7)]
    assert [actor is Actor.EXPERT for actor in actors] == [False, True, True, False, True, False]
    assert gate.decide(SEEN, None).actor is Actor.EXPERT
    with pytest.raises(ParameterError, match="wanted"):
        ScheduledTakeovers([(2, 0)])


def test_the_level_of_a_burden_lies_between_two_that_were_tried():
    ladder = [Rung(-1.0, 0.2, 0.8), Rung(0.0, 1.0, 0.4), Rung(0.1, 0.9, 0.5), Rung(0.2, 3.0, 0.1)]
    level, failed = at_burden(ladder, 0.6)
    assert (level, failed) == pytest.approx((-0.5, 0.6))
    assert at_burden(ladder, 9.0) == pytest.approx((0.2, 0.1))
    # Who may ask for nothing saves nothing.
    assert at_burden(ladder, 0.0) == pytest.approx((-1.0, 1.0))
    assert at_burden(ladder, 0.1) == pytest.approx((-1.0, 0.9))


@pytest.mark.parametrize("last", [3, 4, 18, 19])
def test_the_last_saving_step_is_found_by_halving(last):
    asked: list[int] = []

    def saves(step: int) -> bool:
        asked.append(step)
        return step <= last

    assert last_saving_step(3, 20, saves) == last
    assert len(asked) <= 6
    assert last_saving_step(last + 1, 20, saves) is None


def test_what_failed_and_what_was_asked_are_told_apart():
    trials = [
        Weighed(Trial(1, True, Outcome.FAILURE, 50, ((0, 10),)), 2.0),
        Weighed(Trial(2, True, Outcome.TIME_LIMIT, 100, ()), 2.0),
        Weighed(Trial(3, True, Outcome.SUCCESS, 50, ((0, 10), (20, 30))), 2.0),
        Weighed(Trial(4, False, Outcome.FAILURE, 100, ((0, 50),)), 4.0),
    ]
    of = found(trials, control_rate_hz=10.0)
    assert (of.scenes, of.failed, of.stuck, of.broken, of.unbroken) == (3, 2, 1, 1, 0)
    assert of.burden.takeovers_an_episode == 1.0
    assert of.burden.takeovers_a_minute == pytest.approx(3 / (200 / 600))
    assert of.expert_share == pytest.approx(50 / 200)
    assert of.burden.driving_s_an_episode == pytest.approx(5 / 3)
    assert of.burden.median_takeover_s == 1.0
    assert of.true_mix.failed == pytest.approx(8 / 10)
    assert of.ci95[0] >= 0
    assert of.ci95[1] <= 1


def test_an_interval_draws_scenes_whole():
    values = np.array([0.0, 1.0] * 30)
    apart = interval(range(60), values)
    together = interval([place // 20 for place in range(60)], np.repeat([0.0, 1.0, 0.5], 20))
    assert apart[1] - apart[0] < together[1] - together[0]


def test_a_plan_that_cannot_be_run_is_refused():
    for settings in ({"levels": (0.1,)}, {"levels": (0.2, 0.1)}, {"seeds": ()}):
        with pytest.raises(ParameterError, match="wanted"):
            replace(TakeoversPlan(), **settings)
    with pytest.raises(ParameterError, match="wanted 1 <= failing <= most"):
        Quota(failing=5, most=4)


def test_a_task_has_its_own_quota_and_tuning_a_share_of_it():
    plan = TakeoversPlan(
        scenes=Quota(failing=10), by_task={"corridor": {"scenes": Quota(failing=20)}}
    )
    assert plan.for_task("corridor").quota(FRESH).failing == 20
    assert plan.for_task("another").quota(FRESH).failing == 10
    assert 1 <= plan.for_task("corridor").quota(TUNING).failing < 20
