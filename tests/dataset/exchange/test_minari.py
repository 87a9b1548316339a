"""Minari's data sets, ours and another's, both written by Minari itself."""

import json
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import h5py
import numpy as np
import pytest

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.check import check
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import NOTHING_TOLD, import_episodes
from sheath_manip.dataset.exchange.key_map import KeyMap
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.types import Outcome
from tests.episodes import INFO, episode_of
from tools.foreign_readers import SCRIPTS
from tools.foreign_writers import require_small_set
from tools.identical import identical
from tools.readers.small_set import LENGTHS, after

TOLD = replace(NOTHING_TOLD, info=replace(NOTHING_TOLD.info, control_rate_hz=10.0))


@pytest.fixture
def cubes(tmp_path: Path, monkeypatch) -> Path:
    # Scripts of other venvs import each other from where they are.
    monkeypatch.syspath_prepend(SCRIPTS)
    import_module("write_small_minari").write(tmp_path / "house" / "cubes-v0")
    return tmp_path / "house" / "cubes-v0"


def test_it_comes_in_as_minari_wrote_it(cubes, store) -> None:
    done = import_episodes(open_file("minari", cubes), store, TOLD)
    assert require_small_set(store) > 0
    assert check(store) == []
    first, second, _ = sorted(store.episodes(), key=lambda episode: episode.info.index)
    assert (first.info.task, len(first)) == ("cubes-v0", LENGTHS[0])
    assert np.array_equal(first.final_observation.features, after(0)["state"])
    assert (first.terminated, first.truncated) == (True, False)
    assert (second.outcome, second.truncated) == (Outcome.TIME_LIMIT, True)
    assert "features=observations/robot/state images/camera=observations/camera" in done.remarks[0]


def test_it_is_found_by_its_name_without_a_network(cubes, store, monkeypatch) -> None:
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(cubes.parents[1]))
    file = open_file("minari", Path("house/cubes-v0"))
    assert import_episodes(file, store, TOLD).added == len(LENGTHS)
    with pytest.raises(StoreError, match=r"found none; `minari download D4RL/x` fetches one"):
        open_file("minari", Path("D4RL/x"))
    with pytest.raises(ParameterError, match="does not tell its control rate"):
        import_episodes(file, store, None)


def test_a_success_may_have_another_name_and_keys_are_chosen(cubes, store) -> None:
    with h5py.File(cubes / "data" / "main_data.hdf5", "r+") as file:
        for number in range(len(LENGTHS)):
            infos = file[f"episode_{number}/infos"]
            assert isinstance(infos, h5py.Group)
            infos.move("success", "is_success")
    keys = KeyMap.parse(["features=observations/robot/state,rewards", "images/eye=infos/name"])
    with pytest.raises(StoreError, match="no key 'infos/name' for images/eye"):
        import_episodes(open_file("minari", cubes), store, replace(TOLD, keys=keys))
    keys = KeyMap.parse(["features=observations/robot/state,rewards"])
    failed = replace(TOLD, keys=keys, outcome=Outcome.FAILURE)
    import_episodes(open_file("minari", cubes), store, failed)
    assert {episode.outcome for episode in store.episodes()} == {Outcome.FAILURE}
    assert store.recorded(store.names()[0]).header.feature_size == 4


def test_a_fault_in_one_episode_leaves_none_and_names_it(cubes, store) -> None:
    with h5py.File(cubes / "data" / "main_data.hdf5", "r+") as file:
        del file["episode_1/actions"]
        file["episode_1/actions"] = np.zeros((2, 2), np.float32)
    with pytest.raises(StoreError, match=r"nothing is imported: episode 1 .*actions has 2 rows"):
        import_episodes(open_file("minari", cubes), store, TOLD)
    assert [entry.name for entry in store.path.iterdir()] == ["sheath-store.json"]


def test_a_broken_image_and_another_storage_are_told(cubes, store) -> None:
    with h5py.File(cubes / "data" / "main_data.hdf5", "r+") as file:
        images = file["episode_0/observations/camera"]
        assert isinstance(images, h5py.Dataset)
        images[0] = np.frombuffer(images[0].tobytes()[:40], np.uint8)
    with pytest.raises(StoreError, match="camera"):
        import_episodes(open_file("minari", cubes), store, TOLD)
    metadata = cubes / "data" / "metadata.json"
    metadata.write_text(json.dumps(json.loads(metadata.read_text()) | {"data_format": "arrow"}))
    with pytest.raises(StoreError, match="kept as 'arrow'; wanted Minari's data_format 'hdf5'"):
        open_file("minari", cubes)
    assert store.names() == []


def test_ours_comes_back_as_it_was(store, tmp_path) -> None:
    for index, who in enumerate(("pepp", "ee")):
        store.append(episode_of(who, info=replace(INFO, index=index), side_px=4))
    export(store, tmp_path / "demos-v0", "minari", Selection())
    back = EpisodeStore.create(tmp_path / "back")
    done = import_episodes(open_file("minari", tmp_path / "demos-v0"), back, None)
    assert done.sealed
    assert back.names() == store.names()
    for name in store.names():
        assert identical(back.read(name), store.read(name))
        assert to_attributes(back.header(name)) == to_attributes(store.header(name))
    with h5py.File(tmp_path / "demos-v0" / "data" / "main_data.hdf5", "r+") as file:
        rewards = file["episode_1/rewards"]
        assert isinstance(rewards, h5py.Dataset)
        rewards[0] += 1
    with pytest.raises(StoreError, match="is not what was exported"):
        import_episodes(open_file("minari", tmp_path / "demos-v0"), store, None)
