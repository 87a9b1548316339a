"""Failures are no demonstrations unless they are asked for, and that is said."""

import shutil
from pathlib import Path

import pytest

from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.demonstrations import is_learned_from, left_out_line
from sheath_manip.types import Outcome, Purpose

SMALL = ("--policy.name", "hog-svm", "--gate.signal", "support", "--gate.embedding", "pixels")
LEARN = (
    *("--demonstrations", 3, "--calibration", 4, "--false-alarm-episodes", 1, "--rounds", 1),
    *("--episodes", 1, "--evaluation-episodes", 1, "--final-episodes", 1, *SMALL),
)


@pytest.mark.parametrize("purpose", Purpose)
@pytest.mark.parametrize("failures", [False, True])
def test_what_is_learned_from(purpose: Purpose, failures: bool) -> None:
    by_expert = purpose in (Purpose.DEMONSTRATION, Purpose.CALIBRATION)
    if purpose is Purpose.EVALUATION:
        assert not any(is_learned_from(purpose, outcome, failures) for outcome in Outcome)
        return
    assert is_learned_from(purpose, Outcome.SUCCESS, failures)
    for outcome in (Outcome.FAILURE, Outcome.TIME_LIMIT):
        assert is_learned_from(purpose, outcome, failures) == (failures or not by_expert)


def test_what_is_left_out_is_counted() -> None:
    outcomes = [Outcome.TIME_LIMIT, Outcome.FAILURE, Outcome.FAILURE]
    assert left_out_line(outcomes) == (
        "3 episodes left out, which are no demonstrations: 2 failed, 1 stuck "
        "(--failures takes them)"
    )


def marked(store: Path, *names: str, outcome: Outcome = Outcome.FAILURE) -> None:
    for name in names:
        EpisodeStore(store).mark(name, Marks(outcome=outcome))


def test_train_leaves_failures_out(sheath, complaint, made, tmp_path) -> None:
    store = shutil.copytree(made / "store", tmp_path / "store")
    names = EpisodeStore(store).names()
    marked(store, names[0])
    train = ("train", "corridor", "--store", store, "--checkpoint", tmp_path / "c.npz", *SMALL)
    train = (*train, "--calibration", 4)
    code, out, _ = sheath(*train)
    assert code == 0
    assert "36 states of 3 episodes, 3 succeeded, 0 failed, 0 stuck" in out
    assert "1 episodes left out, which are no demonstrations: 1 failed (--failures takes" in out
    code, out, _ = sheath(*train, "--failures")
    assert code == 0
    assert "48 states of 4 episodes, 3 succeeded, 1 failed, 0 stuck" in out
    assert "left out" not in out
    marked(store, *names[1:4], outcome=Outcome.TIME_LIMIT)
    line = complaint(*train)
    assert "holds 4 expert episodes to learn from (4 episodes left out" in line
    assert "3 stuck (--failures takes them)" in line
    export = ("data", "export", store, tmp_path / "x.hdf5", "--format", "robomimic")
    assert "4 of them did not succeed; --successes leaves" in sheath(*export)[1]


def afresh(runs: Path) -> None:
    """Only what the expert showed stays."""
    shutil.rmtree(runs / "s0")
    for episode in (runs / "store").glob("learning-*"):
        episode.unlink()


def test_learn_leaves_failures_out(sheath, tmp_path) -> None:
    learn = ("learn", "corridor", "--runs", tmp_path, *LEARN)
    code, out, _ = sheath(*learn)
    assert (code, "left out" in out) == (0, False)
    store = EpisodeStore(tmp_path / "store")
    demonstrations = [name for name in store.names() if name.startswith("demonstration")]
    held_out = [name for name in store.names() if name.startswith("calibration")]
    marked(store.path, demonstrations[0], held_out[0])
    afresh(tmp_path)
    code, out, _ = sheath(*learn)
    assert code == 0
    assert "2 episodes left out, which are no demonstrations: 2 failed (--failures" in out
    code, _, err = sheath(*learn, "--failures")
    assert (code, "another failures" in err) == (2, True)
