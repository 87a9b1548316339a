"""The requested action, which replays, and the executed one are in every format."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import zarr

from sheath_manip.dataset.exchange.actions import requested
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.lerobot_columns import columns_of, features
from sheath_manip.dataset.exchange.selection import ActionChoice, Selection
from sheath_manip.dataset.store import EpisodeStore
from tests.episodes import episode_of


@pytest.fixture
def slowed(store: EpisodeStore) -> EpisodeStore:
    """A store of an episode whose commands were halved on their way."""
    episode = episode_of("pepe", side_px=4)
    steps = tuple(replace(step, executed=step.executed / 2) for step in episode.steps)
    store.append(replace(episode, steps=steps))
    return store


def arrays_in(path: Path) -> dict[str, Any]:
    if path.suffix == ".zarr":
        root = zarr.open_group(path, mode="r")
        return {
            name: np.asarray(root[f"data/{name}"]) for name in ("action", "requested", "executed")
        }
    with h5py.File(path if path.is_file() else path / "data" / "main_data.hdf5") as file:
        group: Any = file["data/demo_0" if path.is_file() else "episode_0"]
        infos = group if path.is_file() else group["infos"]
        found = {name: infos[name][()] for name in ("requested", "executed")}
        return {**found, "action": group["actions"][()]}


def test_it_is_what_a_step_says(slowed) -> None:
    name = slowed.names()[0]
    steps = slowed.read(name).steps
    wanted = np.stack([step.requested for step in steps])
    assert np.array_equal(requested(slowed.recorded(name)), wanted)
    assert not np.array_equal(wanted, np.stack([step.executed for step in steps]))


@pytest.mark.parametrize(
    ("form", "target"),
    [("replay-buffer", "a.zarr"), ("robomimic", "a.hdf5"), ("minari", "a-v0")],
)
def test_both_are_in_each_format_and_either_is_the_action(slowed, tmp_path, form, target) -> None:
    recorded = slowed.recorded(slowed.names()[0])
    wanted = {"requested": requested(recorded), "executed": recorded.arrays["executed"]}
    for choice in (ActionChoice.REQUESTED, ActionChoice.EXECUTED):
        path = tmp_path / choice / target
        export(slowed, path, form, Selection(action=choice))
        found = arrays_in(path)
        for name, values in wanted.items():
            assert found[name].tobytes() == values.tobytes(), name
        assert found["action"].tobytes() == wanted[choice].tobytes()


def test_lerobot_has_who_acted_and_why_beside_the_action(slowed) -> None:
    recorded = slowed.recorded(slowed.names()[0])
    columns = columns_of(recorded, ActionChoice.REQUESTED)
    assert np.array_equal(columns["action"], requested(recorded))
    assert np.array_equal(columns["executed"], recorded.arrays["executed"])
    assert columns["intervention"].dtype == bool
    assert columns["intervention"][:, 0].tolist() == [False, True, False, True]
    assert {"actor", "score", "threshold", "requested"} <= columns.keys()
    told = features(recorded, ActionChoice.REQUESTED)
    assert told["intervention"] == {"dtype": "bool", "shape": (1,), "names": None}
    assert told["observation.images.top"]["dtype"] == "image"
