"""Every method on the toy task of buttons: what it labels, who acts, and in which scenes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import UnknownNameError
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.drivers import GatedPolicy
from sheath_manip.learning.methods import METHODS
from sheath_manip.learning.results import round_path, round_results
from sheath_manip.learning.run import LearningRun
from sheath_manip.rollout.request import Driver
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.types import Actor, Reason
from tests.buttons import BUTTONS, PLAN, SPEC, ButtonCorridor
from tests.learning.buttons_run import ORDER, episodes, run, uninterrupted

ALL_LABELLED = {"cloning", "dagger", "dagger-beta", "smile", "sheath", "sheath-plain",
                "random-takeover", "random-blocks"}  # fmt: skip
OWN_LABELS = {"sheath-own-labels", "hg-dagger", "lazy-dagger", "thrifty-dagger",
              "random-own-labels"}  # fmt: skip


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    return uninterrupted(tmp_path_factory)


def steps(directory: Path, method: str) -> list:
    return [step for episode in episodes(directory, method) for step in episode.steps]


@pytest.mark.parametrize("name", ORDER)
def test_every_method_learns_all_rounds(name, whole):
    results = round_results(whole, 0, name)
    assert [result.round for result in results] == list(range(PLAN.schedule.rounds + 1))
    assert len(results[-1].final) == PLAN.comparison.final_episodes
    assert len(episodes(whole, name)) == PLAN.schedule.rounds * PLAN.schedule.episodes
    for result in results:
        # What judges by no signal has no support to be outside of, nor false alarms.
        judges = result.round == 0 or METHODS[name].uses_signal(PLAN)
        assert (0 <= result.bound.xi <= 1) is judges
        assert (0 <= result.false_alarm_rate <= 1) is judges
        assert np.isfinite(result.threshold) == judges
        assert result.bound.horizon > 0


def test_the_rules_of_labels(whole):
    assert ALL_LABELLED | OWN_LABELS | {"shiv"} == set(METHODS)
    for name in ORDER:
        for step in steps(whole, name):
            labelled, expert = step.labelled is not None, step.decision.actor is Actor.EXPERT
            if name in ALL_LABELLED:
                assert labelled
            elif name in OWN_LABELS:
                assert labelled is expert
            else:
                assert labelled is (step.decision.reason is Reason.OUTSIDE)
                assert not expert


@pytest.mark.parametrize("name", ORDER)
def test_states_without_a_label_are_not_learned_from(name, whole):
    results = round_results(whole, 0, name)
    queries = [sum(record.queries for record in result.executed) for result in results]
    assert [result.states for result in results] == np.cumsum(queries).tolist()


def test_all_methods_meet_the_same_scenes(whole):
    seeds = {tuple(e.info.seed for e in episodes(whole, name)) for name in ORDER}
    assert len(seeds) == 1


def unattended(driver: Driver) -> Driver:
    """Nobody watches, so nobody takes over."""
    assert isinstance(driver, GatedPolicy)
    return replace(driver, watched_by=None)


def test_rounds_in_which_nobody_labels_leave_the_policy_as_it_was(tmp_path):
    results = run("hg-dagger", tmp_path, supervised=unattended)
    assert len(results) == PLAN.schedule.rounds + 1
    assert len({result.states for result in results}) == 1
    for result in results[1:]:
        assert np.isnan([result.surrogate_loss, result.bound.measured]).all()
        assert result.missed_rate == 0
    for record in (record for result in results[1:] for record in result.executed):
        assert record.expert_steps == 0
    first = load_checkpoint(round_path(tmp_path, 0, "expert", 0, "npz"), SPEC)
    last = load_checkpoint(round_path(tmp_path, 0, "hg-dagger", 2, "npz"), SPEC)
    assert last.fitted.sources == first.fitted.sources
    learned = last.policy.arrays()
    for key, array in first.policy.arrays().items():
        np.testing.assert_array_equal(learned[key], array)


def test_each_run_has_its_own_scene_for_learning_and_judging(tmp_path):
    made: list[int] = []

    def make_stage(seed: int):
        made.append(seed)
        return BUTTONS.run_variants["stage"](seed)

    task = replace(BUTTONS, run_variants={"stage": make_stage})
    plan = PLAN.changed(schedule={"rounds": 1, "episodes": 1})
    store = EpisodeStore.create(tmp_path / "store")
    for seed in (3, 4):
        made.clear()
        with SerialExecutor() as executor:
            LearningRun(task, plan, seed, tmp_path, store, executor).run("dagger")
        assert set(made) == {seed}
        # One to ask for its spec, and one to learn and to be judged in.
        assert len(made) == 2
    drifts = {cast_stage(seed).drift_m for seed in (0, 1, 2)}
    assert len(drifts) == 3


def cast_stage(seed: int) -> ButtonCorridor:
    stage = BUTTONS.make_for_run("stage", seed)
    assert isinstance(stage, ButtonCorridor)
    return stage


def test_an_unknown_variant_is_named_with_all_there_are(tmp_path):
    with pytest.raises(UnknownNameError, match="known: default, final, stage"):
        run("dagger", tmp_path, PLAN.changed(schedule={"variant": "level"}))
