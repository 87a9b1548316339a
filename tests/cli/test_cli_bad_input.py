"""Bad input: one clear line, exit code 2, nothing recorded is lost."""

import shutil
import socket
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.cli.entry import run_command
from sheath_manip.cli.session import Catalog
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.checkpoint_file import read_arrays, write_arrays
from tests.toy import CORRIDOR, Corridor, MiddleKeeper

VERBS = ("collect", "teleop", "train", "learn", "run", "evaluate", "experiment", "dashboard")
REST = {
    "teleop": ("--store", "x"),
    "learn": ("--runs", "x"),
    "collect": ("--store", "x"),
    "train": ("--store", "x", "--checkpoint", "y"),
    "run": ("--checkpoint", "y"),
    "evaluate": ("--checkpoint", "y"),
    "experiment": (),
    "dashboard": (),
}


def with_header(source: Path, target: Path, **changes: object) -> Path:
    """A copy of the checkpoint with other entries in its header."""
    header, arrays = read_arrays(source)
    del header["digest"]
    with target.open("wb") as file:
        write_arrays(file, header | changes, arrays)
    return target


def _train(complaint, made: Path, tmp_path: Path, *options: object) -> str:
    checkpoint = tmp_path / "c.npz"
    line = complaint(
        "train", "corridor", "--store", made / "store", "--checkpoint", checkpoint, *options
    )
    assert not checkpoint.exists()
    return line


@pytest.mark.parametrize("verb", VERBS)
def test_unknown_task(complaint, verb):
    own = "a task of your own is given as file.py:TASK: docs/own/task.md"
    said = f"unknown task 'moon'; known: corridor; {own}"
    if verb == "experiment":
        said = f"unknown experiment 'moon'; known: corridor, gates, nu, takeovers; {own}"
    assert complaint(verb, "moon", *REST[verb]) == f"sheath: {said}\n"


@pytest.mark.parametrize("verb", ["collect", "run", "evaluate", "dashboard"])
def test_unknown_variant(complaint, made, tmp_path, verb):
    checkpoint = () if verb == "collect" else ("--checkpoint", made / "first.npz")
    store = ("--store", tmp_path / "store") if verb == "collect" else ()
    line = complaint(verb, "corridor", "--variant", "icy", *checkpoint, *store)
    assert line == "sheath: unknown variant of corridor 'icy'; known: default, final\n"
    assert not (tmp_path / "store").exists()


@pytest.mark.parametrize(
    ("option", "kind", "known"),
    [
        ("policy.name", "policy", "cnn"),
        ("gate.embedding", "embedding", "pixels"),
        ("gate.support.name", "support", "one-class-svm"),
    ],
)
def test_unknown_part(complaint, made, tmp_path, option, kind, known):
    line = _train(complaint, made, tmp_path, f"--{option}", "magic")
    assert f"unknown {kind}" in line
    assert "'magic'" in line
    assert known in line


def test_unknown_method(complaint):
    line = complaint("experiment", "corridor", "--methods", "magic")
    assert "unknown method 'magic'; known: cloning, dagger" in line


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("policy.settings", "{"),
        ("policy.settings", 3),
        ("gate.support.nu", -0.1),
        ("gate.support.nu", float("nan")),
        ("gate.support.bandwidth-factor", -1),
        ("gate.threshold.false-alarm-rate", 1.5),
        ("calibration", 2),
        ("calibration", 8),
    ],
)
def test_parameter_outside_its_range(complaint, made, tmp_path, option, value):
    line = _train(complaint, made, tmp_path, f"--{option}", value)
    assert "want" in line
    assert str(value) in line


@pytest.mark.parametrize(
    "argv",
    [
        ("collect", "corridor", "--store", "x", "--episodes", 0),
        ("run", "corridor", "--checkpoint", "y", "--episodes", 0),
        ("evaluate", "corridor", "--checkpoint", "y", "--episodes", -1),
        ("dashboard", "corridor", "--episodes", 0),
        ("dashboard", "corridor", "--speed", 0),
        ("replay", "x", "--speed", "nan"),
        ("experiment", "corridor", "--rounds", 0),
        ("experiment", "corridor", "--seeds"),
        ("experiment", "corridor", "--workers", -1),
        ("experiment", "corridor", "--workers", 2, "--dashboard"),
        ("experiment", "corridor", "--executor", "ray", "--dashboard"),
        ("experiment", "corridor", "--executor", "serial", "--workers", 2),
        ("experiment", "corridor", "--address", "auto"),
        ("collect", "corridor", "--store", "x", "--executor", "ray", "--workers", 0),
        ("experiment", "gates", "--seeds"),
        ("experiment", "gates", "--workers", -1),
        ("experiment", "nu", "--seeds"),
    ],
)
def test_count_or_speed_outside_its_range(complaint, argv, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "wanted" in complaint(*argv)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("benchmark", "known"), [("gates", "full, manipulation, quick"), ("nu", "full, quick")]
)
def test_unknown_plan_of_a_benchmark_moves_nothing_aside(benchmark, known, complaint, tmp_path):
    (tmp_path / "runs").mkdir()
    line = complaint("experiment", benchmark, "--plan", "x", "--fresh", "--runs", tmp_path / "runs")
    assert line == f"sheath: unknown plan of {benchmark} 'x'; known: {known}\n"
    assert [path.name for path in tmp_path.iterdir()] == ["runs"]


@pytest.mark.parametrize("verb", ["list", "check"])
def test_no_store(complaint, tmp_path, verb):
    assert "wanted an episode store" in complaint("data", verb, tmp_path / "none")
    assert "found a directory without" in complaint("data", verb, tmp_path)


def test_nothing_to_replay_and_nothing_to_record_into(complaint, made):
    line = complaint("replay", made / "stor")
    assert "found nothing; give the directory that holds sheath-store.json; did you" in line
    assert f"mean {made / 'store'}?" in line
    assert "record into" not in line


def test_foreign_directory_is_left_alone(complaint, tmp_path):
    (tmp_path / "thesis.tex").write_text("mine")
    complaint("collect", "corridor", "--store", tmp_path, "--episodes", 1)
    complaint("train", "corridor", "--store", tmp_path, "--checkpoint", tmp_path / "c.npz")
    complaint("replay", tmp_path, "--port", 0)
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


def test_store_of_another_task(complaint, made, tmp_path, capsys):
    moon = replace(CORRIDOR, name="moon", variants={"default": _moon}, expert=MiddleKeeper)
    store = tmp_path / "store"
    argv = ["collect", "moon", "--store", str(store), "--episodes", "1"]
    assert run_command(lambda: Catalog({"moon": moon}, {}), argv) == 0
    capsys.readouterr()
    line = complaint("train", "corridor", "--store", store, "--checkpoint", tmp_path / "c.npz")
    assert "task 'moon' instead of 'corridor'" in line
    assert "unknown task 'moon'" in complaint("replay", store, "--port", 0)
    moon_run = ("run", "corridor", "--store", store, "--checkpoint")
    foreign = with_header(made / "first.npz", tmp_path / "moon.npz", task="moon")
    assert "was trained on task 'moon'" in complaint(*moon_run, foreign)


def _moon() -> Corridor:
    corridor = Corridor()
    corridor.spec = replace(corridor.spec, name="moon")
    return corridor


@pytest.mark.parametrize("verb", ["run", "evaluate", "dashboard"])
def test_wrong_checkpoint(complaint, made, tmp_path, verb):
    argv = (verb, "corridor", "--episodes", 1, "--checkpoint")
    line = complaint(*argv, tmp_path / "none.npz")
    assert "no checkpoint at" in line
    assert "`sheath train`" in line
    assert f"did you mean {made / 'first.npz'}?" in complaint(*argv, made / "frist.npz")
    (tmp_path / "text.npz").write_text("not one")
    assert "cannot be read as a checkpoint" in complaint(*argv, tmp_path / "text.npz")
    older = with_header(made / "first.npz", tmp_path / "older.npz", schema=0)
    assert "has schema 0" in complaint(*argv, older)


def test_checkpoint_where_none_can_be_written(complaint, made, tmp_path):
    (tmp_path / "file").write_text("")
    store = ("--store", made / "store")
    complaint("train", "corridor", *store, "--checkpoint", tmp_path / "file" / "c.npz")
    complaint("train", "corridor", *store, "--checkpoint", tmp_path)


def test_truncated_episode(complaint, sheath, made, tmp_path):
    store = shutil.copytree(made / "store", tmp_path / "store")
    name = EpisodeStore(store).names()[0]
    archive = archive_path(store, name)
    archive.write_bytes(archive.read_bytes()[:-10])
    assert name in complaint("replay", store, "--port", 0)
    assert name in complaint("train", "corridor", "--store", store, "--checkpoint", tmp_path / "c")
    code, out, _ = sheath("data", "check", store)
    assert code == 1
    assert "8 episodes, 1 faults" in out


@pytest.mark.parametrize("which", ["8", "-9", "demonstration"])
def test_episode_that_is_not_there(complaint, made, which):
    assert "has no episode" in complaint("replay", made / "store", "--episode", which)


def test_taken_port(complaint, made, tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        page = ("--port", port)
        argv = ("collect", "corridor", "--store", tmp_path / "store", "--dashboard")
        assert f"cannot listen on 127.0.0.1:{port}" in complaint(*argv, *page)
        complaint("dashboard", "corridor", *page)
        complaint("replay", made / "store", *page)
    assert not (tmp_path / "store").exists()


def _failing(after: int, trouble):
    """The toy task, whose expert gets into trouble once it has acted so often."""
    acted = 0

    class Failing(MiddleKeeper):
        def act(self, observation):
            nonlocal acted
            acted += 1
            return trouble() if acted > after else super().act(observation)

    return lambda: Catalog({"corridor": replace(CORRIDOR, expert=Failing)}, {})


def _interrupt():
    raise KeyboardInterrupt


@pytest.mark.parametrize(
    ("trouble", "code", "said", "cut_short"),
    [
        (lambda: np.array([np.nan], np.float32), 2, "action is not finite", 1),
        (_interrupt, 130, "interrupted; what was recorded is kept", 0),
    ],
)
def test_trouble_on_the_way_loses_nothing(capsys, sheath, tmp_path, trouble, code, said, cut_short):
    store = tmp_path / "store"
    argv = ["collect", "corridor", "--store", str(store), "--episodes", "4"]
    assert run_command(_failing(30, trouble), argv) == code
    err = capsys.readouterr().err
    assert said in err
    assert err.count("\n") == 1
    # An attempt that an expert cut short is kept, under a name of its own.
    assert len(EpisodeStore(store).names()) == 2 + cut_short
    assert sheath("data", "check", store)[0] == 0
    assert sheath(*argv)[0] == 0
    assert len(EpisodeStore(store).names()) == 4 + cut_short


def test_interrupt_is_how_the_dashboard_ends(capsys):
    argv = ["dashboard", "corridor", "--port", "0", "--speed", "20"]
    assert run_command(_failing(30, _interrupt), argv) == 0
    assert capsys.readouterr().err == ""


def test_gate_with_a_nan_threshold_is_refused(complaint, made, tmp_path):
    broken = with_header(made / "first.npz", tmp_path / "nan.npz", threshold=float("nan"))
    assert "threshold is NaN" in complaint("run", "corridor", "--checkpoint", broken)


def test_learned_numbers_that_are_none_are_refused(complaint, made, tmp_path):
    with np.load(made / "first.npz") as content:
        arrays = dict(content)
    for part in ("policy/", "signal/"):
        name = next(n for n in arrays if n.startswith(part) and arrays[n].dtype.kind == "f")
        np.savez(tmp_path / "nan.npz", **(arrays | {name: np.full_like(arrays[name], np.nan)}))
        line = complaint("run", "corridor", "--checkpoint", tmp_path / "nan.npz")
        assert name in line
        assert "wanted finite numbers" in line
