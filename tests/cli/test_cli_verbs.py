"""What each verb does where all is well; `experiment` has a file of its own."""

import json
import types

import numpy as np
import pytest

from sheath_manip.cli.entry import OF_A_STORE, OF_A_TASK, run_task_command
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates.constant import AlwaysExpert
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.fitting import looks_of, with_nu
from sheath_manip.learning.training_data import load_training_data
from sheath_manip.rollout import pacing
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.seeding import generator, scene_seed
from sheath_manip.signals.joined import JoinedSignal
from sheath_manip.types import Actor, EpisodeInfo, Purpose
from tests.toy import CATALOG, Corridor, MiddleKeeper


def test_tasks_lists_tasks_and_all_names(sheath):
    code, out, _ = sheath("tasks")
    assert code == 0
    for word in ("corridor", "50 Hz", "above 64x64 px", "sidestep_m: -0.3 | 0 | 0.3", "final"):
        assert word in out
    for name in ("cnn", "pooled-convolutions", "one-class-svm", "random-takeover"):
        assert name in out


def test_collect_records_and_resumes(sheath, tmp_path):
    store = tmp_path / "store"
    assert sheath("collect", "corridor", "--store", store, "--episodes", 2)[0] == 0
    first = {name: archive_path(store, name).stat().st_ino for name in EpisodeStore(store).names()}
    code, out, _ = sheath("collect", "corridor", "--store", store, "--episodes", 3)
    assert code == 0
    assert "3 succeeded, 0 failed, 0 stuck; 36 steps" in out
    assert "2 episodes of them from before" in out
    summaries = EpisodeStore(store).infos()
    assert len(summaries) == 3
    assert {name: archive_path(store, name).stat().st_ino for name in first} == first
    seeds = {scene_seed(Purpose.DEMONSTRATION, 0, 0, index) for index in range(3)}
    assert {summary.info.seed for summary in summaries} == seeds
    assert {summary.queries for summary in summaries} == {12}


def test_collect_keeps_variants_apart(sheath, tmp_path):
    for variant in ("default", "final"):
        options = ("--store", tmp_path / "store", "--episodes", 1, "--variant", variant)
        assert sheath("collect", "corridor", *options)[0] == 0
    summaries = EpisodeStore(tmp_path / "store").infos()
    assert {(s.info.method, s.length) for s in summaries} == {("expert", 12), ("expert-final", 24)}


def test_train_says_what_came_of_it(sheath, made, tmp_path):
    checkpoint = tmp_path / "new" / "second.npz"
    options = (
        "--policy.name",
        "hog-svm",
        "--gate.signal",
        "support",
        "--gate.embedding",
        "pixels",
        "--calibration",
        4,
        "--gate.support.nu",
        0.2,
    )
    code, out, _ = sheath(
        "train", "corridor", "--store", made / "store", "--checkpoint", checkpoint, *options
    )
    assert code == 0
    assert checkpoint.is_file()
    for word in ("48 states of 4 episodes", "training loss", "threshold", "4 held-out expert"):
        assert word in out


def test_run_records_where_a_store_is_given(sheath, made, tmp_path):
    argv = ("run", "corridor", "--checkpoint", made / "first.npz", "--episodes", 2)
    code, out, _ = sheath(*argv, "--store", tmp_path / "store")
    assert code == 0
    for word in ("scene seed", "progress", "takeovers", "labels", "succeeded", "failed", "stuck"):
        assert word in out
    episodes = list(EpisodeStore(tmp_path / "store").episodes())
    assert [episode.info.purpose for episode in episodes] == [Purpose.LEARNING] * 2
    assert all(episode.info.checkpoint for episode in episodes)
    assert all(step.labelled is not None for episode in episodes for step in episode.steps)


def test_run_with_a_stand_in_is_kept_apart_from_the_experts(sheath, made, tmp_path):
    argv = ("run", "corridor", "--checkpoint", made / "first.npz", "--episodes", 1)
    assert sheath(*argv, "--expert", "hold", "--store", tmp_path / "store")[0] == 0
    (episode,) = EpisodeStore(tmp_path / "store").episodes()
    assert episode.info.method.endswith("-hold")
    labels = {float(step.labelled[0]) for step in episode.steps if step.labelled is not None}
    assert labels == {0.0}


def test_run_of_the_policy_alone_asks_no_expert(sheath, made, tmp_path):
    argv = ("run", "corridor", "--checkpoint", made / "first.npz", "--episodes", 1)
    assert sheath(*argv, "--policy-alone", "--store", tmp_path / "store")[0] == 0
    (episode,) = EpisodeStore(tmp_path / "store").episodes()
    assert episode.info.purpose is Purpose.EVALUATION
    assert {step.decision.actor for step in episode.steps} == {Actor.POLICY}
    assert all(step.labelled is None for step in episode.steps)


def test_evaluate_prints_nothing_but_json(sheath, made):
    argv = ("evaluate", "corridor", "--checkpoint", made / "first.npz", "--episodes", 3)
    code, out, err = sheath(*argv, "--json")
    assert (code, err) == (0, "")
    figures = json.loads(out)
    assert figures["episodes"] == 3
    rates = {"failure_rate", "success_rate", "stuck_rate"}
    assert sum(figures[rate] for rate in rates) == pytest.approx(1)
    assert figures["ci95"].keys() == {*rates, "progress"}
    code, out, _ = sheath(*argv)
    assert code == 0
    assert "95 % interval" in out


def test_data_list_and_check(sheath, made):
    code, out, _ = sheath("data", "list", made / "store")
    assert code == 0
    assert "8 episodes, 96 steps" in out
    code, out, _ = sheath("data", "check", made / "store")
    assert code == 0
    assert "0 faults" in out


def test_dashboard_shows_expert_and_policy(sheath, made):
    argv = ("dashboard", "corridor", "--port", 0, "--speed", 20, "--episodes")
    code, out, _ = sheath(*argv, 2)
    assert code == 0
    assert "http://127.0.0.1:" in out
    assert "?token=" in out
    assert out.count("success") == 2
    assert sheath(*argv, 1, "--checkpoint", made / "first.npz")[0] == 0


def test_dashboard_knows_what_the_checkpoint_was_trained_on(sheath, complaint, made, tmp_path):
    argv = ("dashboard", "corridor", "--port", 0, "--speed", 20, "--episodes", 1)
    argv = (*argv, "--checkpoint", made / "first.npz", "--store")
    assert sheath(*argv, made / "store")[0] == 0
    few = EpisodeStore.create(tmp_path / "few")
    few.copy_from(EpisodeStore(made / "store"), EpisodeStore(made / "store").names()[0])
    assert "lacks 7 of the 8 episodes that the checkpoint" in complaint(*argv, few.path)


def test_nu_fits_the_support_anew(made):
    checkpoint = load_checkpoint(made / "first.npz", Corridor().spec)
    data = load_training_data(EpisodeStore(made / "store"), checkpoint, Corridor().spec)
    assert len(data.calibration) == 3
    fitted = checkpoint.fitted
    looks = looks_of(fitted.policy, fitted.fitted_signal, data.states, data.calibration)
    inside = {}
    for nu in (0.05, 0.5):
        again = with_nu(fitted, looks, nu)
        assert again.config.support.nu == nu
        assert np.isfinite(again.threshold)
        assert isinstance(again.signal, JoinedSignal)
        support = again.signal.signals["support"]
        inside[nu] = float((support.scores(support.measure(looks.states)) >= 0).mean())
    # nu bounds the share outside, so at least half stays inside.
    assert 0.5 <= inside[0.5] < inside[0.05]
    assert inside[0.05] >= 0.95


@pytest.mark.parametrize("which", ["0", "-1"])
def test_replay_shows_an_episode(sheath, made, which):
    argv = ("replay", made / "store", "--episode", which, "--once", "--speed", 20, "--port", 0)
    code, out, _ = sheath(*argv)
    assert code == 0
    assert "12 steps, success" in out


def test_pacing_keeps_the_control_rate():
    environment = Corridor()
    info = EpisodeInfo("corridor", 0, Purpose.LEARNING, 50.0)
    sleeps = []
    clock = types.SimpleNamespace(sleep=sleeps.append, monotonic=lambda: sum(sleeps))
    with pytest.MonkeyPatch.context() as patch:
        # Not the real clock, by which the threads of other tests' pages go.
        patch.setattr(pacing, "time", clock)
        rollout(
            environment,
            info,
            AlwaysExpert(),
            rng=generator("none"),
            expert=MiddleKeeper(environment),
            listeners=(Pacing(speed=2.0),),
        )
    assert sleeps == pytest.approx([0.01] * 12)


def test_task_script_has_the_verbs_without_the_task(capsys, tmp_path):
    argv = ["collect", "--store", str(tmp_path / "store"), "--episodes", "1"]
    assert run_task_command(lambda: CATALOG, "corridor", argv) == 0
    assert len(EpisodeStore(tmp_path / "store").names()) == 1
    with pytest.raises(SystemExit):
        run_task_command(lambda: CATALOG, "corridor", ["--help"])
    text = capsys.readouterr().out
    assert all(verb in text for verb in (*OF_A_TASK, *OF_A_STORE))
    with pytest.raises(SystemExit):
        run_task_command(lambda: CATALOG, "corridor", ["collect", "--help"])
    assert "TASK" not in capsys.readouterr().out
