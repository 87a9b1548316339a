"""Rounds of learning on the toy task never learn from what judges, and end where they are to."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, SheathError
from sheath_manip.learning.checkpoint import digest, load_checkpoint
from sheath_manip.learning.results import round_path, round_results
from sheath_manip.metrics import expert_share
from sheath_manip.types import Actor, Purpose
from tests.learning.corridor_run import BEGUN, FILES, METHODS, SMALL_PLAN, run, uninterrupted
from tests.toy import Corridor

pytestmark = pytest.mark.usefixtures("small_policy_known")


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    return uninterrupted(tmp_path_factory)


def test_every_round_leaves_its_checkpoint_and_its_result(whole):
    runs = whole / "s0"
    assert sorted(path.name for path in runs.iterdir()) == ["expert", *sorted(METHODS)]
    assert sorted(path.name for path in (runs / "expert").iterdir()) == [
        "round-00.json",
        "round-00.npz",
    ]
    for method in METHODS:
        begun = [] if method == "sheath" else [BEGUN]
        assert sorted(path.name for path in (runs / method).iterdir()) == [*begun, *FILES]
        results = round_results(whole, 0, method)
        assert [result.round for result in results] == [0, 1, 2]
        assert [result.method for result in results] == ["expert", method, method]
        for result in results:
            name = f"round-{result.round:02d}.npz"
            assert result.checkpoint == digest(runs / result.method / name)
            checkpoint = load_checkpoint(runs / result.method / name, Corridor().spec)
            assert (checkpoint.round, checkpoint.method) == (result.round, result.method)
            np.testing.assert_equal(checkpoint.threshold, result.threshold)
        assert [len(result.final) for result in results] == [
            0,
            0,
            SMALL_PLAN.comparison.final_episodes,
        ]


def test_states_are_aggregated(whole):
    for method in METHODS:
        results = round_results(whole, 0, method)
        steps = [sum(record.steps for record in result.executed) for result in results]
        states = [result.states for result in results]
        assert states == [sum(steps[: number + 1]) for number in range(3)]


def test_the_policy_that_drove_is_the_one_fitted_the_round_before(whole):
    store = EpisodeStore(whole / "store")
    for method in METHODS:
        before = [result.checkpoint for result in round_results(whole, 0, method)]
        if method != "sheath":
            shared, begun = (round_path(whole, 0, name, 0, "npz") for name in ("expert", method))
            first, own = (load_checkpoint(path, Corridor().spec) for path in (shared, begun))
            for key, array in first.policy.arrays().items():
                np.testing.assert_array_equal(own.policy.arrays()[key], array)
            before[0] = digest(begun)
        for number in (1, 2):
            drove = {e.info.checkpoint for e in store.episodes(method=method, round=number)}
            assert drove == {before[number - 1]}


def test_sheath_hands_over_and_random_takeover_gets_its_share(whole):
    store = EpisodeStore(whole / "store")
    actors = {step.decision.actor for e in store.episodes(method="sheath") for step in e.steps}
    assert actors == {Actor.POLICY, Actor.EXPERT}
    for sheath, random in zip(*(round_results(whole, 0, name) for name in METHODS), strict=True):
        share = expert_share(sheath.executed)
        steps = sum(record.steps for record in random.executed)
        # Three standard deviations of the drawn share.
        spread = 3 * (share * (1 - share) / steps) ** 0.5
        assert expert_share(random.executed) == pytest.approx(share, abs=spread + 1e-9)


def test_no_scene_that_judges_is_ever_trained_on(whole):
    store = EpisodeStore(whole / "store")
    by_purpose: dict[Purpose, set[int]] = {purpose: set() for purpose in Purpose}
    for summary in store.infos():
        by_purpose[summary.info.purpose].add(summary.info.seed)
    # Evaluation is not recorded: nothing of it can be learned from.
    assert by_purpose[Purpose.EVALUATION] == set()
    judged = {
        record.seed
        for method in METHODS
        for result in round_results(whole, 0, method)
        for record in (*result.policy, *result.final)
    }
    trained = by_purpose[Purpose.DEMONSTRATION] | by_purpose[Purpose.LEARNING]
    assert len(judged) == SMALL_PLAN.comparison.evaluation_episodes
    assert (
        len(trained)
        == SMALL_PLAN.schedule.demonstrations
        + SMALL_PLAN.schedule.rounds * SMALL_PLAN.schedule.episodes
    )
    assert (
        len(by_purpose[Purpose.CALIBRATION])
        == SMALL_PLAN.schedule.calibration + SMALL_PLAN.schedule.false_alarm_episodes
    )
    assert not judged & trained
    assert not judged & by_purpose[Purpose.CALIBRATION]
    assert not trained & by_purpose[Purpose.CALIBRATION]


def test_all_methods_meet_the_same_scenes(whole):
    for results in zip(*(round_results(whole, 0, name) for name in METHODS), strict=True):
        for part in ("executed", "policy", "final"):
            first, second = ([record.seed for record in getattr(r, part)] for r in results)
            assert first == second


def test_a_finished_method_is_read_and_not_run(whole):
    for method in METHODS:
        reports: list[str] = []
        results = run(method, whole, report=reports.append)
        assert reports == [f"{method} is done"] * SMALL_PLAN.units_of_run()
        assert results == round_results(whole, 0, method)


def test_random_takeover_without_sheath_says_what_is_missing(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "run")
    for method in METHODS:
        shutil.rmtree(tmp_path / "run" / "s0" / method)
    with pytest.raises(ParameterError, match="run sheath first") as caught:
        run("random-takeover", tmp_path / "run")
    assert "\n" not in str(caught.value)


def test_an_unknown_method_is_named(tmp_path):
    with pytest.raises(SheathError, match="unknown method 'shaeth'"):
        run("shaeth", tmp_path)


def test_rounds_end_once_the_loss_is_low_enough(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "run")
    plan = SMALL_PLAN.changed(schedule={"stop_below_loss": 1.1})
    for _ in range(2):
        results = run("dagger", tmp_path / "run", plan)
        assert [result.round for result in results] == [0, 1]
        assert len(results[-1].final) == plan.comparison.final_episodes
    names = sorted(path.name for path in (tmp_path / "run" / "s0" / "dagger").iterdir())
    assert names == [BEGUN, *FILES[:2]]


def test_a_method_that_follows_one_that_stopped_stops_with_it(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "run")
    for method in METHODS:
        shutil.rmtree(tmp_path / "run" / "s0" / method)
    run("sheath", tmp_path / "run", SMALL_PLAN.changed(schedule={"stop_below_loss": 1.1}))
    # What random takeover meets where its own loss is not low enough yet.
    results = run("random-takeover", tmp_path / "run")
    assert [result.round for result in results] == [0, 1]


def test_each_rounds_gate_keeps_to_the_rate_of_its_round(tmp_path):
    plan = SMALL_PLAN.changed(schedule={"first_false_alarm_rate": 0.8})
    run("sheath", tmp_path, plan)
    paths = [round_path(tmp_path, 0, "expert", 0, "npz")]
    paths += [round_path(tmp_path, 0, "sheath", number, "npz") for number in (1, 2)]
    gates = [load_checkpoint(path, Corridor().spec).fitted for path in paths]
    # Each is fitted for the round that follows, the last for a third one.
    assert [gate.config.threshold.false_alarm_rate for gate in gates] == [0.8, 0.4, 0.3]
    assert gates[0].threshold > gates[2].threshold
