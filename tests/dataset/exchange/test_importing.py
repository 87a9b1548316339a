"""Files that other tools wrote."""

import json
import zipfile
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np
import pytest
import zarr

from sheath_manip.dataset.archive import give_name
from sheath_manip.dataset.check import check
from sheath_manip.dataset.exchange import importing
from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import Origin, import_episodes
from sheath_manip.dataset.exchange.key_map import KeyMap
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, SheathError, StoreError
from sheath_manip.policies import make_policy
from sheath_manip.support import make_support
from sheath_manip.types import ActionSpec, EpisodeInfo, Outcome, Purpose, TaskSpec
from sheath_manip.types.samples import samples_from
from tests.dataset.exchange.conftest import LENGTHS

INFO = EpisodeInfo("push", 0, Purpose.DEMONSTRATION, 10.0, method="pusht")


def origin(*keys: str) -> Origin:
    return Origin(INFO, Outcome.SUCCESS, KeyMap.parse(keys))


@pytest.fixture
def buffer(tmp_path: Path, arrays) -> Path:
    path = tmp_path / "pusht.zarr"
    root = zarr.create_group(path, zarr_format=2)
    for name, values in arrays.items():
        root.create_array(f"data/{name}", data=values, chunks=(3, *values.shape[1:]))
    root.create_array("meta/episode_ends", data=np.cumsum(LENGTHS))
    return path


@pytest.fixture
def hdf5(tmp_path: Path, arrays) -> Path:
    path = tmp_path / "lift.hdf5"
    with h5py.File(path, "w") as file:
        start = 0
        # Out of order, as HDF5 lists demo_10 before demo_2.
        for name, length in zip(("demo_2", "demo_10"), LENGTHS, strict=True):
            demo, part = file.create_group(f"data/{name}"), slice(start, start + length)
            demo.attrs["num_samples"] = length
            demo["actions"], demo["rewards"] = arrays["action"][part], np.arange(float(length))
            demo["obs/eye_image"] = arrays["img"][part].astype(np.uint8)
            demo["obs/pos"], demo["next_obs/pos"] = arrays["state"][part], arrays["state"][part] + 1
            demo["obs/gripper"] = arrays["keypoint"][part]
            start += length
    return path


def imported(path: Path, form: str, store: EpisodeStore, *keys: str) -> list:
    import_episodes(open_file(form, path), store, origin(*keys))
    assert check(store) == []
    return list(store.episodes())


def test_a_replay_buffer_by_its_keys(buffer, store, arrays) -> None:
    keys = ("images/top=img", "features=keypoint,state")
    first, second = imported(buffer, "replay-buffer", store, *keys)
    assert (len(first), len(second)) == LENGTHS
    assert second.info.index == second.info.seed == 1
    step = second.steps[0]
    assert np.array_equal(step.observation.images["top"], arrays["img"][4])
    assert step.observation.features.tolist() == pytest.approx(
        [*arrays["keypoint"][4].ravel(), *arrays["state"][4]]
    )
    assert step.labelled is not None
    assert step.labelled.tobytes() == step.executed.tobytes() == arrays["action"][4].tobytes()
    assert first.outcome is Outcome.SUCCESS
    assert first.terminated
    # Nobody knows what was seen after the last action.
    assert np.array_equal(first.final_observation.images["top"], arrays["img"][3])
    assert first.final_observation.time_s == pytest.approx(0.4)


def test_robomimic_by_its_keys(hdf5, store, arrays) -> None:
    keys = ("images/eye=obs/eye_image", "features=obs/pos")
    first, second = imported(hdf5, "robomimic", store, *keys)
    assert (len(first), len(second)) == LENGTHS
    assert [step.reward for step in first.steps] == [0, 1, 2, 3]
    assert np.array_equal(second.steps[-1].observation.features, arrays["state"][-1])
    assert np.array_equal(second.final_observation.features, arrays["state"][-1] + 1)


def test_an_import_is_repeated_without_harm(buffer, store) -> None:
    file = open_file("replay-buffer", buffer)
    assert import_episodes(file, store, origin("features=state")).added == 2
    again = import_episodes(file, store, origin("features=state"))
    assert (again.added, again.held) == (0, 2)


def test_it_serves_for_cloning_and_for_a_support(tmp_path, store) -> None:
    rng = np.random.default_rng(1)
    state = rng.uniform(-1, 1, (200, 3)).astype(np.float32)
    pressed = (state[:, :1] > 0).astype(np.float32)
    root = zarr.create_group(tmp_path / "b.zarr", zarr_format=2)
    root.create_array("data/agent_pos", data=state)
    root.create_array("data/action", data=pressed)
    root.create_array("meta/episode_ends", data=np.arange(20, 201, 20))
    file = open_file("replay-buffer", tmp_path / "b.zarr")
    import_episodes(file, store, origin("features=agent_pos"))
    samples = samples_from(store.episodes())
    off, on = np.zeros(1, np.float32), np.ones(1, np.float32)
    action = ActionSpec(("press",), off, on, np.stack([off, on]))
    spec = TaskSpec("push", 10.0, action, {}, ("a", "b", "c"), 100, "progress")
    policy = make_policy("linear-svm", spec, seed=0).fit(samples)
    assert (
        policy.surrogate_losses(policy.predict(samples.observations), samples.labels).mean() < 0.1
    )
    support = make_support("one-class-svm", nu=0.1).fit(samples.features)
    assert (support.decision_function(samples.features) > 0).mean() > 0.8
    assert (support.decision_function(samples.features + 9) > 0).mean() == 0


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        (["features=pos"], "no key 'pos' for features; it has action, img, keypoint, state"),
        (["images/top=state"], r"state is \(4, 5\); wanted one key of images"),
        (["action=gone"], "no key 'gone' for action"),
    ],
)
def test_wrong_keys_are_one_line(buffer, store, keys, message) -> None:
    with pytest.raises(StoreError, match=message):
        import_episodes(open_file("replay-buffer", buffer), store, origin(*keys))
    assert store.names() == []


@pytest.mark.parametrize("word", ["features", "=x", "actions=x", "images/../x=y", "features="])
def test_a_word_that_is_no_key_is_refused(word) -> None:
    with pytest.raises(ParameterError, match="is not OURS=THEIRS"):
        KeyMap.parse([word])


def test_images_must_be_bytes(tmp_path, store, arrays) -> None:
    root = zarr.create_group(tmp_path / "x.zarr", zarr_format=2)
    root.create_array("data/img", data=arrays["img"] / 255)
    root.create_array("data/action", data=arrays["action"])
    root.create_array("meta/episode_ends", data=np.cumsum(LENGTHS))
    with pytest.raises(StoreError, match=r"not in whole numbers 0 .. 255"):
        imported(tmp_path / "x.zarr", "replay-buffer", store, "images/top=img")


def test_another_tools_file_needs_its_origin(buffer, hdf5, store) -> None:
    for form, path in (("replay-buffer", buffer), ("robomimic", hdf5)):
        with pytest.raises(ParameterError, match="give --task and --control-rate-hz"):
            import_episodes(open_file(form, path), store, None)


def test_a_rate_that_the_file_says_is_held_against_what_is_told(hdf5, store) -> None:
    with h5py.File(hdf5, "r+") as file:
        told = {"env_name": "Lift", "type": 1, "env_kwargs": {"control_freq": 20}}
        file["data"].attrs["env_args"] = json.dumps(told)
    file = open_file("robomimic", hdf5)
    with pytest.raises(ParameterError, match=r"recorded at 20 Hz, not at 10 Hz; give .* 20"):
        import_episodes(file, store, origin("features=obs/pos"))
    assert store.names() == []
    right = replace(origin("features=obs/pos"), info=replace(INFO, control_rate_hz=20.0))
    assert import_episodes(file, store, right).added == 2


def test_a_format_without_masks_says_so(buffer, store) -> None:
    told = replace(origin("features=state"), mask="train")
    with pytest.raises(ParameterError, match="no list 'train' of episodes; it has none"):
        import_episodes(open_file("replay-buffer", buffer), store, told)


def test_a_file_without_an_episode_is_told(tmp_path, store) -> None:
    root = zarr.create_group(tmp_path / "none.zarr", zarr_format=2)
    root.create_array("data/action", data=np.zeros((0, 2)))
    root.create_array("meta/episode_ends", data=np.zeros(0, np.int64))
    with h5py.File(tmp_path / "none.hdf5", "w") as file:
        file.create_group("data")
    for form, name in (("replay-buffer", "none.zarr"), ("robomimic", "none.hdf5")):
        with pytest.raises(StoreError, match="holds no episode"):
            import_episodes(open_file(form, tmp_path / name), store, origin())


def shorten(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def broken(tmp_path: Path, buffer: Path, hdf5: Path) -> dict[str, tuple[str, Path]]:
    """Files that are no ReplayBuffer and no robomimic file, or were once."""
    (tmp_path / "text.zip").write_text("no zip")
    (tmp_path / "text.hdf5").write_text("no HDF5")
    (tmp_path / "folder.zarr").mkdir()
    with zipfile.ZipFile(tmp_path / "empty.zip", "w"):
        pass
    with h5py.File(tmp_path / "other.hdf5", "w") as file:
        file["x"] = 1
    shorten(hdf5)
    root = zarr.open_group(buffer, mode="r+")
    root.create_array("data/short", data=np.zeros(2))
    replay, robomimic = "replay-buffer", "robomimic"
    return {
        "text as zip": (replay, tmp_path / "text.zip"),
        "empty zip": (replay, tmp_path / "empty.zip"),
        "empty folder": (replay, tmp_path / "folder.zarr"),
        "nothing": (replay, tmp_path / "none"),
        "a short array": (replay, buffer),
        "text as HDF5": (robomimic, tmp_path / "text.hdf5"),
        "other HDF5": (robomimic, tmp_path / "other.hdf5"),
        "cut HDF5": (robomimic, hdf5),
        "no HDF5": (robomimic, tmp_path / "none"),
        "a folder as HDF5": (robomimic, tmp_path / "folder.zarr"),
    }


def test_broken_files_are_one_line(tmp_path, buffer, hdf5, store) -> None:
    for what, (form, path) in broken(tmp_path, buffer, hdf5).items():
        with pytest.raises(SheathError) as caught:
            import_episodes(open_file(form, path), store, origin())
        assert "\n" not in str(caught.value), what
        assert str(path) in str(caught.value), what
    assert store.names() == []


@pytest.mark.parametrize("cause", [OSError("no space left"), KeyboardInterrupt()])
def test_what_fails_on_the_way_into_the_store_leaves_none(buffer, store, monkeypatch, cause):
    def second_fails(directory: Path, final: Path) -> None:
        if store.names():
            raise cause
        give_name(directory, final)

    monkeypatch.setattr(importing, "give_name", second_fails)
    with pytest.raises((StoreError, KeyboardInterrupt)):
        import_episodes(open_file("replay-buffer", buffer), store, origin("features=state"))
    assert [entry.name for entry in store.path.iterdir()] == ["sheath-store.json"]


def test_a_fault_in_one_episode_leaves_none_and_names_it(hdf5, store) -> None:
    with h5py.File(hdf5, "r+") as file:
        del file["data/demo_10/obs/pos"]
        file["data/demo_10/obs/pos"] = h5py.SoftLink("/data/demo_2/obs/pos")
    with pytest.raises(StoreError, match=r"nothing is imported: episode 1 .*demo_10.*SoftLink"):
        import_episodes(open_file("robomimic", hdf5), store, origin("features=obs/pos"))
    assert [entry.name for entry in store.path.iterdir()] == ["sheath-store.json"]
