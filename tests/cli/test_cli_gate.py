"""`sheath gate`: from a policy and recorded episodes to a file for anybody's loop."""

import shutil
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import zarr

from sheath_manip.adapters.from_callable import from_callable
from sheath_manip.adapters.recorded_episodes import told_origin
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.gate_file import gate_facts, load_gate
from sheath_manip.types import Actor, Observation
from tests import frozen

MINE = """
import numpy as np
import torch

WEIGHTS = -np.eye(2, dtype=np.float32)
NUMBER = 3


def act(observation):
    return np.clip(WEIGHTS @ observation.features, -1, 1)


def breaks(observation):
    raise ZeroDivisionError("oh no\\nreally")


class Mine:
    pass


class Holder:
    network = torch.nn.Sequential(torch.nn.Linear(2, 2), torch.nn.Hardtanh())
"""


@pytest.fixture(scope="module")
def theirs(tmp_path_factory) -> Path:
    """A folder of somebody else's, with a policy and recordings in two formats."""
    folder = tmp_path_factory.mktemp("theirs")
    (folder / "mine.py").write_text(MINE)
    store = EpisodeStore.create(folder / "store")
    for number in range(9):
        store.append(frozen.demonstration(number, "to the middle"), frozen.SPACE)
    buffer = zarr.create_group(folder / "demos.zarr", zarr_format=2)
    shown = [frozen.demonstration(number) for number in range(12)]
    states = np.concatenate([each.columns.features for each in shown])
    actions = np.concatenate([each.columns.labels for each in shown])
    for name, values in (("data/state", states), ("data/action", actions)):
        buffer.create_array(name, data=values)
    buffer.create_array("meta/episode_ends", data=np.cumsum([len(each) for each in shown]))
    return folder


@pytest.fixture(autouse=True)
def _place(theirs, monkeypatch):
    """Work in that folder, of which no module is left behind."""
    monkeypatch.setattr(sys, "path", [str(theirs), *sys.path])
    sys.modules.pop("mine", None)
    monkeypatch.chdir(theirs)
    yield
    sys.modules.pop("mine", None)
    Path("gate.npz").unlink(missing_ok=True)


def fit(sheath, *more, policy="mine.py:act", data="store"):
    return sheath("gate", "fit", "--policy", policy, "--data", data, "--out", "gate.npz", *more)


def test_from_a_store_to_a_loop_of_ones_own(sheath) -> None:
    code, out, err = fit(sheath, "--gate.minimum-hold-steps", 2)
    assert (code, err) == (0, "")
    for words in (
        "150 states of 6 episodes",
        "signal near-joined: the support on scaled-features",
        "75 states of 3 held-out episodes",
        "15.0% asked for",
    ):
        assert words in out
    facts = gate_facts("gate.npz")
    assert (facts.external.named, facts.external.data) == ("mine.py:act", "store")
    assert facts.external.instruction == "to the middle"
    assert facts.config.minimum_hold_steps == 2
    assert set(facts.sources.fitted_to + facts.sources.held_out) == set(
        EpisodeStore("store").names()
    )
    told: list[str] = []

    def act(observation: Observation) -> np.ndarray:
        told.append(observation.instruction)
        return frozen.steered(observation.features)

    gate = load_gate("gate.npz", from_callable(act))
    # As the recordings told it, also where it is only looked whether it is the same.
    assert set(told) == {"to the middle"}
    gate.reset()
    actors = [
        gate.decide(frozen.seen(at), frozen.steered(np.array(at))).actor
        for at in ([0.1, 0.2], [5, 5], [0.1, 0.2], [0.1, 0.2], [0.1, 0.2])
    ]
    assert actors == [Actor.POLICY, Actor.EXPERT, Actor.EXPERT, Actor.POLICY, Actor.POLICY]


def test_another_tools_data_and_a_torch_module(sheath, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    data = "replay-buffer:demos.zarr"
    told = ("--keys", "features=state", "--task", "point", "--control-rate-hz", 20)
    code, out, err = fit(sheath, *told, policy="mine:Holder.network", data=data)
    assert (code, err) == (0, "")
    assert "200 states of 8 episodes" in out
    recorded = gate_facts("gate.npz").external.recorded
    assert (recorded.task, recorded.control_rate_hz) == ("point", 20)
    # What was imported for this is gone.
    assert list(tmp_path.iterdir()) == []


def test_show_runs_no_code_and_tells_all(sheath) -> None:
    assert fit(sheath)[0] == 0
    del sys.modules["mine"]
    code, out, err = sheath("gate", "show", "gate.npz")
    assert (code, err) == (0, "")
    assert "mine" not in sys.modules
    for words in ("mine.py:act", "point, 20 Hz", "to the middle", "x_m, y_m", "vx, vy", "6 episod"):
        assert words in out


@pytest.mark.parametrize(
    ("policy", "says"),
    [
        ("mine.py", "does not say where a policy is; wanted file.py:POLICY"),
        ("nobody.py:act", "there is no file nobody.py"),
        ("nobody:act", "nobody cannot be imported (ModuleNotFoundError"),
        ("mine.py:acts", "unknown name in mine.py 'acts'; known: "),
        ("mine.py:Mine", "is the class Mine; wanted an object of it"),
        ("mine.py:NUMBER", "is of type int and lacks reset, propose, predict, surrogate_losses"),
        ("mine.py:breaks", "the policy broke down (ZeroDivisionError: oh no really)"),
        ("mine.py:WEIGHTS", "is of type ndarray"),
        ("lerobot:nowhere", ""),
    ],
)
def test_a_policy_that_is_none_is_one_line(complaint, policy, says) -> None:
    argv = ("gate", "fit", "--policy", policy, "--data", "store", "--out", "gate.npz")
    assert says in complaint(*argv)
    assert not Path("gate.npz").exists()


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (("--data", "nowhere"), "nowhere"),
        (("--data", "lerobot:nowhere"), "nowhere"),
        (("--data", "minari:nobody/nothing-v0"), "nothing-v0"),
        (("--data", "replay-buffer:demos.zarr"), "give --task and --control-rate-hz"),
        (("--calibration", 9), "9 expert episodes to learn from; wanted more than the 9"),
        (("--calibration", 2), "the threshold wants at least 3"),
        (("--control-rate-hz", -1), "control rate -1.0 Hz"),
        (("--keys", "features"), "is not OURS=THEIRS"),
        (("--gate.embedding", "latent"), "gives none; wanted one, as `from_torch"),
        (("--gate.embedding", "pixels"), "there is no camera"),
        (("--gate.signal", "hunch"), "unknown signal 'hunch'"),
        (("--gate.kind", "mixture"), "judges by nothing that could be fitted"),
        (("--out", "."), "is a directory"),
    ],
)
def test_what_cannot_be_fitted_is_one_line(complaint, more, says) -> None:
    given = {"--policy": "mine.py:act", "--data": "store", "--out": "gate.npz"}
    given |= dict([more])
    assert says in complaint("gate", "fit", *(word for pair in given.items() for word in pair))
    assert not Path("gate.npz").exists()


def test_a_gate_alone_is_no_checkpoint_of_a_run(sheath, complaint) -> None:
    assert fit(sheath)[0] == 0
    said = complaint("run", "corridor", "--checkpoint", "gate.npz")
    assert "holds a gate alone" in said
    assert "load_gate(path, policy)" in said
    assert "no checkpoint at" in complaint("gate", "show", "nowhere.npz")


def test_data_of_several_tasks_is_one_line(complaint, tmp_path) -> None:
    mixed = tmp_path / "mixed"
    shutil.copytree("store", mixed)
    other = frozen.demonstration(70)
    info = replace(other.info, task="other", method="other")
    EpisodeStore(mixed).append(replace(other, info=info))
    argv = ("gate", "fit", "--policy", "mine.py:act", "--data", mixed, "--out", "gate.npz")
    assert "give data of one task" in complaint(*argv)
    with pytest.raises(ParameterError, match="control rate"):
        told_origin(control_rate_hz=float("nan"))
