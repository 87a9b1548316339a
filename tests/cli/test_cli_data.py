"""`sheath data`: every verb, where all is well and where it is not."""

import shutil
from importlib.util import find_spec
from pathlib import Path

import h5py
import numpy as np
import pytest
import zarr

from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.store import EpisodeStore
from tests.cli.conftest import run
from tests.dataset.folders import unpacked
from tools.identical import identical


@pytest.fixture(scope="session")
def demos(tmp_path_factory) -> Path:
    """A store of 3 demonstrations of 12 steps."""
    store = tmp_path_factory.mktemp("demos") / "store"
    assert run("collect", "corridor", "--store", store, "--episodes", 3) == 0
    return store


@pytest.fixture
def store(demos: Path, tmp_path: Path, monkeypatch) -> Path:
    """A copy to change, told as users do: from where they are."""
    shutil.copytree(demos, tmp_path / "store")
    monkeypatch.chdir(tmp_path)
    return Path("store")


def names(store: Path) -> list[str]:
    return EpisodeStore(store).names()


class TestLook:
    def test_list_names_outcomes_shares_and_sizes(self, sheath, demos):
        code, out, err = sheath("data", "list", demos)
        assert (code, err) == (0, "")
        for name in names(demos):
            assert name in out
        assert "3 episodes, 36 steps" in out
        assert "3 succeeded, 0 failed, 0 stuck; the expert acted in 100% of the steps" in out

    def test_list_card(self, sheath, demos):
        code, out, err = sheath("data", "list", demos, "--card", "--licence", "CC-BY-4.0")
        assert (code, err) == (0, "")
        lines = out.splitlines()
        assert lines[0] == "# Episodes of the task corridor"
        for line in (
            "- licence: CC-BY-4.0",
            "- control rate: 50 Hz",
            "- outcomes: 3 succeeded, 0 failed, 0 stuck",
            "- progress: mean 1",
            "| `images/above` | uint8 | (T, 64, 64, 3) | RGB, before the action |",
            "| `features` | float32 | (T, 2) | what is measured, before the action: `x_m`, `y_m` |",
            "| `final/time_s` | float64 | () | s, since the episode began, after the last action |",
        ):
            assert line in lines
        (executed,) = [line for line in lines if line.startswith("| `executed`")]
        assert executed.endswith(": `sidestep_m` |")

    def test_a_card_of_nothing(self, complaint, tmp_path):
        EpisodeStore.create(tmp_path / "empty")
        assert "has no episode" in complaint("data", "list", tmp_path / "empty", "--card")

    @pytest.mark.parametrize("episode", ["0", "-1", "2"])
    def test_show(self, sheath, demos, episode):
        code, out, err = sheath("data", "show", demos, "--episode", episode)
        assert (code, err) == (0, "")
        assert out.splitlines()[0] == names(demos)[int(episode)]
        assert "12 steps at 50 Hz, 0.2 s" in out
        assert "success (terminated)" in out
        assert "images/above" in out

    def test_show_of_what_is_not_there(self, complaint, demos):
        for episode in ("3", "-4", "x"):
            line = complaint("data", "show", demos, "--episode", episode)
            assert "wanted a name of `sheath data list`, or a number below 3" in line

    def test_check(self, sheath, store):
        assert sheath("data", "check", store)[:2] == (
            0,
            "3 episodes, 0 faults, 0 harmless leftovers\n",
        )
        inside = unpacked(EpisodeStore(store), names(store)[1])
        (inside / "executed" / "c.0.0").write_bytes(b"x")
        shutil.rmtree(inside / "score")
        (store / ".tmp-1").mkdir()
        code, out, err = sheath("data", "check", store)
        assert (code, err) == (1, "")
        assert "3 episodes, 2 faults, 1 harmless leftovers" in out
        for words in ("executed does not decode", "the array score is missing", "cut off"):
            assert words in out
        # Only the damaged one is out of reach.
        assert sheath("data", "list", store)[0] == 0
        assert names(store)[1] in sheath("data", "show", store, "--episode", "1")[2]

    @pytest.mark.parametrize("verb", ["list", "show", "check", "repair"])
    def test_no_store(self, complaint, tmp_path, verb):
        assert "wanted an episode store" in complaint("data", verb, tmp_path)


SETS = Path(__file__).parents[1] / "dataset" / "exchange" / "sets"
EXPORTS = {
    "demos.zarr": "replay-buffer",
    "demos.zarr.zip": "replay-buffer",
    "demos.hdf5": "robomimic",
    "demos-v0": "minari",
}


class TestExchange:
    @pytest.mark.parametrize("target", EXPORTS)
    def test_export_and_import(self, sheath, complaint, store, target):
        form = ("--format", EXPORTS[target])
        code, out, err = sheath("data", "export", store, f"out/{target}", *form)
        assert (code, out, err) == (0, f"out/{target}: 3 episodes, 36 steps\n", "")
        assert [path.name for path in Path("out").iterdir()] == [target]
        again = complaint("data", "export", store, f"out/{target}", *form)
        assert "exists, and it is kept" in again
        code, out, _ = sheath("data", "import", f"out/{target}", "back", *form)
        assert (code, out) == (0, "3 episodes added to back, 0 were there before\n")
        back, there = EpisodeStore("back"), EpisodeStore(store)
        assert back.names() == there.names()
        assert all(identical(back.read(name), there.read(name)) for name in there.names())
        code, out, _ = sheath("data", "import", f"out/{target}", "back", *form)
        assert (code, out) == (0, "0 episodes added to back, 3 were there before\n")

    def test_export_of_a_part(self, sheath, complaint, store):
        form = ("--format", "robomimic")
        part = ("--successes", "--expert-steps", "--action", "labelled", "--rounds", 0, 1)
        assert sheath("data", "export", store, "part.hdf5", *form, *part)[0] == 0
        with h5py.File("part.hdf5") as file:
            assert len(np.array(file["mask/success"])) == 3
        line = complaint("data", "export", store, "none.hdf5", *form, "--rounds", 7)
        assert "of the 3 episodes in store nothing is selected" in line
        assert not Path("none.hdf5").exists()

    def test_lerobot_tells_what_it_lacks(self, complaint, store):
        if find_spec("lerobot"):
            pytest.skip("LeRobot is installed")
        line = complaint("data", "export", store, "out", "--format", "lerobot")
        assert "wants the package lerobot" in line
        assert "sheath-manip[lerobot]" in line
        assert not Path("out").exists()

    def test_import_of_another_tools_file(self, sheath, complaint, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        rng = np.random.default_rng(0)
        root = zarr.create_group("pusht.zarr", zarr_format=2)
        root.create_array("data/img", data=rng.integers(0, 256, (9, 8, 8, 3), np.uint8))
        for name, size in (("agent_pos", 2), ("block", 3), ("action", 2)):
            root.create_array(f"data/{name}", data=rng.normal(size=(9, size)).astype(np.float32))
        root.create_array("meta/episode_ends", data=np.array([4, 9]))
        file = ("data", "import", "pusht.zarr", "store", "--format", "replay-buffer")
        assert "give --task and --control-rate-hz" in complaint(*file)
        told = ("--task", "push", "--control-rate-hz", 10)
        for rate in (0, -1, "nan", "inf", "1e308", "5e-324"):
            assert "wanted 0.001 .. 1e+06" in complaint(*file, *told[:3], rate)
        assert "is not OURS=THEIRS" in complaint(*file, *told, "--keys", "img")
        assert "the file has no key 'pos'" in complaint(*file, *told, "--keys", "features=pos")
        keys = ("--keys", "images/top=img", "features=agent_pos,block")
        code, out, err = sheath(*file, *told, *keys)
        assert (code, err) == (0, "")
        assert "2 episodes added to store, 0 were there before" in out
        assert "pusht.zarr has no digests" in out
        assert sheath("data", "check", "store")[0] == 0
        assert "pusht" in names(Path("store"))[0]
        # Another file of the same name is no reason to keep quiet.
        root.create_array("data/action", data=np.zeros((9, 2), np.float32), overwrite=True)
        line = complaint(*file, *told, *keys)
        assert "holds another episode" in line
        assert "--method" in line
        assert sheath(*file, *told, *keys, "--method", "zeros")[0] == 0
        assert len(names(Path("store"))) == 4

    def test_import_of_what_lerobot_wrote(self, sheath, complaint, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        file = ("data", "import", SETS / "lerobot-v3.0", "store", "--format", "lerobot")
        assert "does not tell one task; give --task" in complaint(*file)
        code, out, err = sheath(*file, "--task", "cubes", "--outcome", "failure")
        assert (code, err) == (0, "")
        lines = " ".join(out.split())
        assert "3 episodes added to store" in lines
        assert "taken: action=action reward=next.reward features=observation.state" in lines
        assert "not taken: next.success" in lines
        assert "0 succeeded, 3 failed, 0 stuck" in sheath("data", "list", "store")[1]
        assert "wanted an HDF5 file" in complaint(*file[:-1], "robomimic")

    @pytest.mark.parametrize("form", ["replay-buffer", "robomimic", "lerobot", "minari"])
    def test_import_of_no_file(self, complaint, tmp_path, form):
        (tmp_path / "text").write_text("mine")
        for file in ("none", "text"):
            line = complaint("data", "import", tmp_path / file, tmp_path / "s", "--format", form)
            assert str(tmp_path / file) in line
        assert not (tmp_path / "s").exists()


class TestKeep:
    def test_merge(self, sheath, complaint, store):
        one = ("--episodes", 1, "--seed", 5)
        assert sheath("collect", "corridor", "--store", "more", *one)[0] == 0
        code, out, _ = sheath("data", "merge", store, "more", "--into", "all")
        assert (code, out) == (0, "4 episodes copied into all, 0 were there before\n")
        code, out, _ = sheath("data", "merge", store, "--into", "all")
        assert (code, out) == (0, "0 episodes copied into all, 3 were there before\n")
        assert sorted(names(Path("all"))) == sorted(names(store) + names(Path("more")))
        assert "no store to merge" in complaint("data", "merge", "--into", "all")
        assert "found nothing" in complaint("data", "merge", "none", "--into", "all")

    def test_split(self, sheath, complaint, store):
        line = ("data", "split", store, "train=0.7", "test=0.3", "--into", "parts")
        code, out, _ = sheath(*line)
        assert (code, out) == (0, "parts/train: 2 episodes\nparts/test: 1 episodes\n")
        parts = names(Path("parts/train")) + names(Path("parts/test"))
        assert sorted(parts) == names(store)
        assert "exists, and it is kept" in complaint(*line)
        for words in (["train"], ["train=x"], ["train=0.7"], ["a=0.99", "b=0.01"], []):
            complaint("data", "split", store, *words, "--into", "other")
        assert not Path("other").exists()

    def test_drop(self, sheath, complaint, store):
        first, second, third = names(store)
        assert "no episode to drop" in complaint("data", "drop", store)
        # All or none.
        assert "has no episode 'x'" in complaint("data", "drop", store, first, "x")
        assert len(names(store)) == 3
        code, out, _ = sheath("data", "drop", store, first, third, first)
        assert (code, out) == (0, f"dropped {first}\ndropped {third}\n")
        assert names(store) == [second]

    def test_repair(self, sheath, complaint, store):
        (store / ".tmp-1").mkdir()
        code, out, _ = sheath("data", "repair", store)
        assert code == 0
        assert "written to within 600 s, so left: .tmp-1" in out
        assert "0 faults, 1 harmless leftovers" in out
        first = names(store)[0]
        archive_path(store, first).rename(archive_path(store, first.replace("i000", "i009")))
        code, out, _ = sheath("data", "repair", store, "--idle-s", 0)
        assert code == 0
        assert "swept away .tmp-1" in out
        assert f"has its name again: {first}" in out
        assert "3 episodes, 0 faults, 0 harmless leftovers" in out
        archive_path(store, first).write_bytes(b"")
        assert sheath("data", "repair", store)[0] == 1
        assert len(names(store)) == 3
        assert "wanted 0 or more" in complaint("data", "repair", store, "--idle-s", "nan")
