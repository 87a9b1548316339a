"""What a run costs, what it has to wait for, and how long it takes on so many cores."""

import io

import numpy as np
import pytest
from rich.console import Console

from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments.scale.costs import (
    Costs,
    Line,
    MethodCosts,
    measure_costs,
    over_and_over,
    trial_of,
)
from sheath_manip.experiments.scale.estimate import (
    estimated_costs,
    moved,
    print_estimate,
    read_costs,
    speedup,
)
from sheath_manip.experiments.scale.schedule import Machines, longest_chain_s, wall_s
from sheath_manip.experiments.scale.work import Work, work_of
from sheath_manip.learning.config import LearningPlan
from sheath_manip.types.samples import Samples
from tests.toy import PLAN, STUDY

METHOD = MethodCosts(2.0, 1.0, Line(1.0, 0.001), 1.0, 100.0)
PLANNED = LearningPlan().changed(
    comparison={"methods": ("sheath", "random-takeover"), "seeds": (0, 1)}, schedule={"rounds": 2}
)
COSTS = Costs(
    1.0,
    3.0,
    100.0,
    Line(0.0, 0.01),
    {"sheath": METHOD, "random-takeover": METHOD},
    episode_b=1e6,
    checkpoint_b=1e5,
)


def piece(kind, cpu_s: float, *after: int) -> Work:
    return Work(kind, cpu_s, after)


def test_cores_take_what_is_ready_and_fits_go_first() -> None:
    work = [
        piece("judging", 3.0),
        piece("recorded", 1.0),
        piece("recorded", 1.0),
        piece("fit", 2.0, 1, 2),
    ]
    assert wall_s(work, Machines(1)) == 7.0
    # Both episodes first, then the fit beside what only judges.
    assert wall_s(work, Machines(2)) == 4.0
    assert wall_s(work, Machines(64)) == longest_chain_s(work) == 3.0


def test_a_device_takes_the_fits() -> None:
    work = [piece("fit", 10.0), piece("fit", 10.0), piece("recorded", 3.0)]
    assert wall_s(work, Machines(1, 1, device_speedup=10.0)) == 3.0
    assert wall_s(work, Machines(1, 1, device_speedup=2.0)) == 10.0


def test_pieces_are_those_of_the_plan() -> None:
    work = work_of(COSTS, PLANNED)
    schedule, comparison = PLANNED.schedule, PLANNED.comparison
    expert = schedule.demonstrations + schedule.calibration + schedule.false_alarm_episodes
    recorded = expert + 2 * schedule.rounds * schedule.episodes
    judging = (1 + 2 * schedule.rounds) * comparison.evaluation_episodes
    judging += 2 * comparison.final_episodes
    kinds = [each.kind for each in work]
    assert kinds.count("recorded") == 2 * recorded
    assert kinds.count("judging") == 2 * judging
    assert sum(each.cpu_s for each in work if each.kind == "judging") == 2 * judging * 3.0
    # A first fit to the demonstrations, then to what each round adds.
    fits = [each.cpu_s for each in work if each.kind == "fit"]
    assert max(fits) == pytest.approx(0.01 * 100 * schedule.demonstrations)


def test_many_cores_end_where_the_longest_chain_does() -> None:
    work = work_of(COSTS, PLANNED)
    chain_s = longest_chain_s(work)
    assert wall_s(work, Machines(1)) == pytest.approx(sum(each.cpu_s for each in work))
    assert wall_s(work, Machines(2)) < 0.55 * wall_s(work, Machines(1))
    assert wall_s(work, Machines(10_000)) == pytest.approx(chain_s)
    assert speedup(work, Machines(8)) > 6


def test_a_line_is_never_below_nothing() -> None:
    assert Line.through([1.0, 2.0, 3.0], [3.0, 5.0, 7.0]).at(10.0) == pytest.approx(21.0)
    assert Line.through([1.0, 2.0], [5.0, 3.0]) == Line(4.0, 0.0)
    assert Line.through([1.0, 2.0], [1.0, 4.0]).fixed_s == 0.0


def test_states_over_and_over_are_no_copies() -> None:
    images = np.arange(2 * 3 * 4 * 3, dtype=np.uint8).reshape(2, 3, 4, 3)
    features = np.array([[0], [1]], np.float32)
    episodes = np.zeros(2, np.int64)
    samples = Samples({"front": images}, features, features + 2, episodes)
    many = over_and_over(samples, 5)
    assert many.features.ravel().tolist() == [0, 1, 0, 1, 0]
    assert many.labels.ravel().tolist() == [2, 3, 2, 3, 2]
    shown = many.images["front"]
    np.testing.assert_array_equal(shown[:2], images)
    np.testing.assert_array_equal(shown[2], np.roll(images[0], 1, axis=1))
    np.testing.assert_array_equal(shown[4], np.roll(images[0], 2, axis=1))


def test_a_refit_is_measured_at_the_end_of_the_plan(tmp_path) -> None:
    plan = PLAN.changed(
        policy={"name": "hog-svm"},
        gate={"signal": "support", "embedding": "pixels"},
        comparison={"methods": ("sheath",)},
    )
    heard: list[str] = []
    measure_costs(STUDY.task, plan, tmp_path, heard.append)
    schedule = plan.schedule
    rounds = schedule.rounds * schedule.episodes
    most = 12 * (schedule.demonstrations + rounds) + 1
    (fitted,) = (word for word in heard if word.startswith("sheath fit to"))
    assert 12 * schedule.demonstrations <= int(fitted.split()[3]) <= most


def test_a_trial_measures_all_that_the_plan_does(tmp_path) -> None:
    plan = PLAN.changed(
        policy={"name": "hog-svm"},
        gate={"signal": "support", "embedding": "pixels"},
        comparison={"methods": ("random-takeover", "sheath")},
    )
    costs = estimated_costs(STUDY, plan, tmp_path / "estimate", lambda _: None)
    assert set(costs.methods) == set(plan.comparison.methods)
    assert min(costs.expert_s, costs.alone_s, costs.fit.at(100), costs.episode_b) > 0
    assert all(each.episode_s > 0 for each in costs.methods.values())
    assert costs.states_each == pytest.approx(12, abs=1)
    # It was measured once and for all.
    assert estimated_costs(STUDY, plan, tmp_path / "estimate", pytest.fail) == costs
    assert read_costs(tmp_path / "estimate" / "costs.json") == costs
    more = plan.changed(schedule={"rounds": 40})
    with pytest.raises(ParameterError, match=r"schedule\.rounds"):
        estimated_costs(STUDY, more, tmp_path / "estimate", pytest.fail)


def test_the_estimate_is_told() -> None:
    out = io.StringIO()
    print_estimate(COSTS, PLANNED, Console(file=out, width=160))
    told = out.getvalue()
    assert "64" in told
    assert "GB of episodes come back" in told
    assert moved(COSTS, PLANNED).checkpoints_b == 2 * (1 + 2 * 2) * 1e5
    assert trial_of(PLANNED).schedule.calibration == PLANNED.schedule.calibration
    with pytest.raises(ParameterError, match="wanted at least 1"):
        Machines(0)
