"""Every method on the toy task of buttons: what it labels, who acts, and that it resumes."""

import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import UnknownNameError
from sheath_manip.gates import SupportGate
from sheath_manip.learning.checkpoint import Checkpoint, digest, load_checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.drivers import GatedPolicy
from sheath_manip.learning.methods import METHODS
from sheath_manip.learning.results import RoundResult, round_path, round_results
from sheath_manip.learning.run import LearningRun
from sheath_manip.metrics import expert_share
from sheath_manip.policies.linear_svm import LinearSvm
from sheath_manip.policies.smile import SmileMixture, expert_weight
from sheath_manip.rollout.request import Driver
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.types import Actor, Episode, Purpose, Reason
from tests.buttons import BUTTONS, PLAN, SPEC, ButtonCorridor
from tests.writing import WriterHere

# What is followed comes first.
ORDER = sorted(METHODS, key=lambda name: METHODS[name].share_from is not None)
ALL_LABELLED = {"cloning", "dagger", "dagger-beta", "smile", "sheath", "sheath-plain",
                "random-takeover"}  # fmt: skip
OWN_LABELS = {"sheath-own-labels", "hg-dagger", "lazy-dagger", "thrifty-dagger",
              "random-own-labels"}  # fmt: skip


def run(
    method: str, directory: Path, plan: LearningPlan = PLAN, seed: int = 0, **options
) -> list[RoundResult]:
    store = EpisodeStore.create(directory / "store")
    with SerialExecutor() as executor:
        return LearningRun(BUTTONS, plan, seed, directory, store, executor, **options).run(method)


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """All methods from one seed, never interrupted."""
    directory = tmp_path_factory.mktemp("whole")
    for name in ORDER:
        run(name, directory)
    return directory


def episodes(directory: Path, method: str, number: int | None = None) -> list[Episode]:
    return list(EpisodeStore(directory / "store").episodes(method=method, round=number))


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


def test_a_method_with_another_gate_begins_with_the_shared_policy(whole):
    def checkpoint(method: str) -> Checkpoint:
        return load_checkpoint(round_path(whole, 0, method, 0, "npz"), SPEC)

    shared = checkpoint("expert").policy.arrays()
    for name in sorted(set(METHODS) - {"sheath", "smile"}):
        for key, array in checkpoint(name).policy.arrays().items():
            np.testing.assert_array_equal(array, shared[key])
        drove = {episode.info.checkpoint for episode in episodes(whole, name, 1)}
        assert drove == {digest(round_path(whole, 0, name, 0, "npz"))}
    smile = checkpoint("smile").policy.arrays()
    np.testing.assert_array_equal(smile["0/machines"], shared["machines"])
    assert not round_path(whole, 0, "sheath", 0, "npz").exists()
    drove = {episode.info.checkpoint for episode in episodes(whole, "sheath", 1)}
    assert drove == {digest(round_path(whole, 0, "expert", 0, "npz"))}


def test_what_holds_or_labels_otherwise_is_not_fitted_for_that(whole):
    shared = load_checkpoint(round_path(whole, 0, "expert", 0, "npz"), SPEC)
    for name in ("sheath-own-labels", "shiv"):
        own = load_checkpoint(round_path(whole, 0, name, 0, "npz"), SPEC)
        assert own.fitted.config == METHODS[name].plan(PLAN).gate != shared.fitted.config
        assert (own.threshold, own.training_loss) == (shared.threshold, shared.training_loss)
        for key, array in own.fitted.fitted_signal.arrays().items():
            np.testing.assert_array_equal(array, shared.fitted.fitted_signal.arrays()[key])


def test_every_checkpoint_knows_its_gate_and_its_episodes(whole):
    store = EpisodeStore(whole / "store")
    expert = {each.name: each.info for each in store.infos() if each.info.method == "expert"}
    for name in ORDER:
        for number in (1, 2):
            checkpoint = load_checkpoint(round_path(whole, 0, name, number, "npz"), SPEC)
            share = checkpoint.fitted.config.expert_share
            wanted = METHODS[name].plan(PLAN).changed(gate={"expert_share": share})
            assert checkpoint.fitted.config == wanted.gate
            assert (checkpoint.fitted.signal is not None) is METHODS[name].uses_signal(PLAN)
            sources = checkpoint.fitted.sources
            assert [expert[each].index for each in sources.held_out] == [0, 1, 2]
            assert {expert[each].purpose for each in sources.held_out} == {Purpose.CALIBRATION}
            learned = {
                each.name
                for each in store.infos()
                if each.queries
                and each.info.purpose in (Purpose.DEMONSTRATION, Purpose.LEARNING)
                and each.info.method in ("expert", name)
                and each.info.round <= number
            }
            assert set(sources.fitted_to) == learned
            assert len(sources.fitted_to) == len(learned)


def test_the_plain_gate_is_the_drafts(whole):
    checkpoint = load_checkpoint(round_path(whole, 0, "sheath-plain", 2, "npz"), SPEC)
    assert checkpoint.threshold == 0
    assert checkpoint.fitted.config.signal == "support"
    learned = checkpoint.fitted.fitted_signal.arrays()
    assert learned["support/c"] == pytest.approx(0.01 * len(SPEC.feature_names))


def test_the_lazy_gate_hands_back_later_than_it_takes_over(whole):
    checkpoint = load_checkpoint(round_path(whole, 0, "lazy-dagger", 0, "npz"), SPEC)
    assert checkpoint.fitted.release_margin > 0
    gate = checkpoint.gate()
    assert isinstance(gate, SupportGate)
    assert (gate.release_margin, gate.query) == (checkpoint.fitted.release_margin, False)
    sheath = load_checkpoint(round_path(whole, 0, "expert", 0, "npz"), SPEC)
    assert (sheath.fitted.release_margin, sheath.threshold) == (0, checkpoint.threshold)


def test_smile_has_a_policy_a_round_and_the_paper_share_of_the_expert(whole):
    for number in range(PLAN.schedule.rounds + 1):
        path = round_path(whole, 0, "smile", number, "npz")
        policy = load_checkpoint(path, SPEC).policy
        assert isinstance(policy, SmileMixture)
        assert (len(policy.members_), policy.alpha) == (number + 1, PLAN.schedule.alpha)
        assert isinstance(policy.members_[0], LinearSvm)
    for result in round_results(whole, 0, "smile")[1:]:
        count = sum(record.steps for record in result.executed)
        share = expert_weight(PLAN.schedule.alpha, result.round)
        spread = 3 * (share * (1 - share) / count) ** 0.5
        assert expert_share(result.executed) == pytest.approx(share, abs=spread)


def test_the_experts_part_decays_by_beta(tmp_path):
    plan = PLAN.changed(schedule={"beta": 0.6, "episodes": 6})
    for result in run("dagger-beta", tmp_path, plan)[1:]:
        share, count = 0.6**result.round, sum(record.steps for record in result.executed)
        spread = 3 * (share * (1 - share) / count) ** 0.5
        assert expert_share(result.executed) == pytest.approx(share, abs=spread)


def test_a_budget_is_kept_nearly(tmp_path):
    plan = PLAN.changed(schedule={"episodes": 8})
    results = run("thrifty-dagger", tmp_path, plan)
    shares = [expert_share(result.executed) for result in results[2:]]
    assert np.mean(shares) == pytest.approx(plan.gate.threshold.expert_budget, abs=0.12)


def test_a_follower_of_own_labels_gets_their_share(whole):
    for ours, theirs in zip(
        round_results(whole, 0, "random-own-labels")[1:],
        round_results(whole, 0, "sheath-own-labels")[1:],
        strict=True,
    ):
        share = expert_share(theirs.executed)
        count = sum(record.steps for record in ours.executed)
        spread = 3 * (share * (1 - share) / count) ** 0.5
        assert expert_share(ours.executed) == pytest.approx(share, abs=spread + 1e-9)


def unattended(driver: Driver) -> Driver:
    """Nobody watches, so nobody takes over."""
    assert isinstance(driver, GatedPolicy)
    return replace(driver, attended=False)


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


def contents(directory: Path, name: str) -> dict[str, str]:
    """Digests of the checkpoints and the results but for the time they took."""
    found = {path.name: digest(path) for path in (directory / "s0" / name).glob("*.npz")}
    for path in (directory / "s0" / name).glob("*.json"):
        found[path.name] = repr(json.loads(path.read_text()) | {"wall_s": None})
    return found


class StoppedError(Exception):
    """Stands for the power cut."""


@pytest.fixture
def _cut(monkeypatch) -> Iterator[None]:
    """Stops before every file, once."""
    seen: set[str] = set()
    for owner, name in ((WriterHere, "append_arrays"), (Checkpoint, "save")):
        write = getattr(owner, name)

        def written(*arguments, write=write):
            header = getattr(arguments[1], "header", None)
            file = str(arguments[1] if header is None else header.info)
            if file not in seen:
                seen.add(file)
                raise StoppedError(file)
            return write(*arguments)

        monkeypatch.setattr(owner, name, written)
    yield
    assert seen


@pytest.mark.usefixtures("_cut")
@pytest.mark.parametrize("name", ["smile", "thrifty-dagger", "shiv", "hg-dagger"])
def test_stopped_at_any_file_it_resumes_to_the_same_result(name, whole, tmp_path):
    shutil.copytree(whole / "s0" / "expert", tmp_path / "s0" / "expert")
    shutil.copytree(whole / "store", tmp_path / "store")
    for path in (tmp_path / "store").glob("learning-*"):
        shutil.rmtree(path)
    for _ in range(100):
        try:
            run(name, tmp_path)
        except StoppedError:
            continue
        break
    assert contents(tmp_path, name) == contents(whole, name)
