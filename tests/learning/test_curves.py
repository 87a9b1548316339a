"""What the page's learning curves show, from rounds as an experiment might give them."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.experiments.summary import summarise
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.curves import SHARE, Curves
from sheath_manip.learning.pooled import MANY_RUNS
from sheath_manip.learning.results import EXPERT, RoundResult
from sheath_manip.metrics import RATES, expert_share_interval
from tests.experiments.round_results import expert_records_of, results_of

PLAN = LearningPlan().changed(
    comparison={
        "methods": ("dagger", "sheath"),
        "seeds": (0, 1, 2),
        "evaluation_episodes": 6,
        "final_episodes": 2,
    },
    schedule={"rounds": 3, "episodes": 5},
)


def as_told(plan: LearningPlan) -> list[RoundResult]:
    """In the order of an experiment, in which every method tells of the shared round 0 again."""
    return [result for rounds in results_of(plan).values() for result in rounds]


def curves_of(results: list[RoundResult]) -> Curves:
    curves = Curves("laps")
    curves.take(results)
    return curves


@pytest.mark.parametrize("seeds", [(0, 1, 2), tuple(range(MANY_RUNS))])
def test_page_and_figures_say_the_same(seeds):
    plan = PLAN.changed(comparison={"seeds": seeds})
    summary = summarise("toy", plan, results_of(plan), expert_records_of(plan), "sheath", 1.0)
    curves = curves_of(as_told(plan))
    assert curves.methods == list(plan.comparison.methods)
    for method, found in summary["methods"].items():
        for entry in found["rounds"]:
            name = method if entry["round"] else EXPERT
            for field in ("executed", "policy"):
                of_round, figures = entry["round"], entry[field]
                for rate in RATES.values():
                    reading = curves.line(name, field, rate)[of_round]
                    assert reading.value == figures[rate]
                    assert list(reading.interval) == list(figures["ci95"][rate])
                    assert reading.episodes == figures["episodes"]
                reading = curves.line(name, field, "laps")[of_round]
                assert reading.value == figures["metric"]["laps"]
                assert list(reading.interval) == list(figures["ci95"]["laps"])
            assert curves.line(name, "executed", SHARE)[of_round].value == entry["expert_share"]


def test_a_value_lies_in_its_interval_and_among_its_seeds():
    curves = curves_of(as_told(PLAN))
    for method in (EXPERT, *curves.methods):
        for quantity in (*RATES.values(), "laps", SHARE):
            for reading in curves.line(method, "executed", quantity).values():
                low, high = reading.interval
                assert low - 1e-9 <= reading.value <= high + 1e-9
                assert list(reading.seeds) == [0, 1, 2]
                values = list(reading.seeds.values())
                assert min(values) - 1e-9 <= reading.value <= max(values) + 1e-9


def test_what_is_told_twice_counts_once():
    results = as_told(PLAN)
    curves = curves_of(results)
    before = curves.line(EXPERT, "policy", "laps")
    curves.take(results)
    assert curves.line(EXPERT, "policy", "laps") == before
    assert before[0].episodes == 3 * PLAN.comparison.evaluation_episodes


def test_results_may_come_one_by_one_and_in_any_order():
    results = as_told(PLAN)
    at_once, one_by_one = curves_of(results), Curves("laps")
    for count in range(1, len(results) + 1):
        one_by_one.take(results[::-1][:count])
    for method in at_once.methods:
        found = one_by_one.line(method, "executed", "laps")
        assert list(found) == [1, 2, 3]
        for number, reading in at_once.line(method, "executed", "laps").items():
            assert found[number].value == pytest.approx(reading.value)


def test_of_a_metric_that_nothing_measured_there_is_no_value():
    results = [replace(result, policy=()) for result in as_told(PLAN)]
    reading = curves_of(results).line("sheath", "policy", "laps")[1]
    assert np.isnan(reading.value)
    assert np.isnan(reading.interval).all()
    assert reading.episodes == 0


def test_a_share_of_steps_has_an_interval_within_its_episodes():
    records = [
        replace(record, expert_steps=number * record.steps // 10)
        for number, record in enumerate(results_of(PLAN)["sheath"][1].executed)
    ]
    shares = [record.expert_steps / record.steps for record in records]
    low, high = expert_share_interval(records)
    assert min(shares) <= low < high <= max(shares)
    # As many steps in each: the plain mean's.
    same = [replace(record, steps=100, expert_steps=40) for record in records]
    assert expert_share_interval(same) == pytest.approx((0.4, 0.4))
    assert expert_share_interval([]) == (0.0, 1.0)
