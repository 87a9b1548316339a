"""What robosuite's script for collecting demonstrations writes, with states and without images."""

import json
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest

from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import NOTHING_TOLD, import_episodes
from sheath_manip.dataset.exchange.sources import import_data
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from tests.dataset.exchange.conftest import LENGTHS


@pytest.fixture
def raw(tmp_path: Path, arrays) -> Path:
    """As robosuite's script for collecting demonstrations writes them."""
    path = tmp_path / "demo.hdf5"
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        told = {"env_name": "Lift", "robots": ["Panda"], "control_freq": 20}
        data.attrs["env"], data.attrs["env_info"] = "Lift", json.dumps(told)
        for number, part in ((1, slice(0, 4)), (2, slice(4, 10))):
            demo = data.create_group(f"demo_{number}")
            demo.attrs["model_file"] = "<mujoco/>"
            demo["states"], demo["actions"] = arrays["keypoint"][part, 0], arrays["action"][part]
    return path


def test_robosuites_raw_file_has_states_for_features(raw, store, arrays) -> None:
    done = import_episodes(open_file("robomimic", raw), store, None)
    assert done.remarks == (
        "taken: action=actions state=states features=states",
        "not taken: model_file",
    )
    first, second = sorted(store.episodes(), key=len)
    assert (len(first), len(second)) == LENGTHS
    assert (first.info.task, first.info.control_rate_hz) == ("Lift", 20.0)
    assert np.array_equal(second.steps[0].state, arrays["keypoint"][4, 0])
    assert np.array_equal(second.steps[0].observation.features, second.steps[0].state.astype("f4"))
    assert np.array_equal(second.steps[-1].executed, arrays["action"][-1])


def test_a_mask_chooses_and_names_stay(raw, store) -> None:
    with h5py.File(raw, "r+") as file:
        file["mask/train"], file["mask/valid"] = [b"demo_2"], [b"demo_1"]
        file["mask/gone"] = [b"demo_7"]

    def taken(mask: str):
        return import_episodes(open_file("robomimic", raw), store, replace(NOTHING_TOLD, mask=mask))

    assert taken("train").added == 1
    (trained,) = store.episodes()
    assert (trained.info.index, len(trained)) == (1, 6)
    with pytest.raises(ParameterError, match="no list 'x' of episodes; wanted one of gone, train"):
        taken("x")
    with pytest.raises(StoreError, match="mask/gone names 'demo_7', and it is not there"):
        taken("gone")
    done = taken("")
    assert (done.added, done.held) == (1, 1)
    assert done.remarks[-1].endswith("--mask takes those of a list: gone, train, valid")


def test_a_line_of_python_does_as_the_command(raw, tmp_path) -> None:
    keys = {"features": "actions,states"}
    done = import_data(f"robomimic:{raw}", tmp_path / "s", task="lift", keys=keys)
    assert done.added == 2
    recorded = EpisodeStore(tmp_path / "s")
    header = recorded.header(recorded.names()[0])
    assert (header.info.task, header.info.method, header.feature_size) == ("lift", "demo", 4)
    for source in ("moon:x", "robomimic", "robomimic:"):
        with pytest.raises(ParameterError, match=r"is no FORMAT:PATH; wanted one of replay-buffer"):
            import_data(source, tmp_path / "s")
    with pytest.raises(ParameterError, match=r"control rate nan Hz; wanted 0.001"):
        import_data(f"robomimic:{raw}", tmp_path / "s", control_rate_hz=float("nan"))
