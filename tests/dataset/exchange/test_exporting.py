from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import SheathError, StoreError
from tests.dataset.folders import unpacked
from tests.episodes import INFO, episode_of

TARGETS = {
    "replay-buffer": ("demos.zarr", "demos.zarr.zip"),
    "robomimic": ("demos.hdf5",),
    "minari": ("demos-v0",),
}
CASES = [(form, target) for form, targets in TARGETS.items() for target in targets]


@pytest.fixture
def two(store: EpisodeStore) -> EpisodeStore:
    for index in range(2):
        store.append(episode_of("pe", info=replace(INFO, index=index), side_px=4))
    return store


@pytest.mark.parametrize(("form", "target"), CASES)
def test_an_interruption_leaves_nothing(two, tmp_path: Path, form, target) -> None:
    def interrupt(_: str) -> None:
        raise KeyboardInterrupt

    out = tmp_path / "out"
    out.mkdir()
    with pytest.raises(KeyboardInterrupt):
        export(two, out / target, form, Selection(), interrupt)
    assert list(out.iterdir()) == []


@pytest.mark.parametrize(("form", "target"), CASES)
def test_what_is_there_is_kept(two, tmp_path: Path, form, target) -> None:
    (tmp_path / target).write_text("mine")
    with pytest.raises(StoreError, match="exists, and it is kept"):
        export(two, tmp_path / target, form, Selection())
    assert (tmp_path / target).read_text() == "mine"


@pytest.mark.parametrize(("form", "target"), CASES)
def test_a_damaged_episode_leaves_nothing(two, tmp_path: Path, form, target) -> None:
    (unpacked(two, two.names()[1]) / "executed" / "c.0.0").unlink()
    with pytest.raises(StoreError, match=r"executed/c.0.0 is missing"):
        export(two, tmp_path / "out" / target, form, Selection())
    assert not (tmp_path / "out" / target).exists()
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize("form", ["replay-buffer", "minari"])
def test_episodes_of_other_shapes_are_refused(two, tmp_path: Path, form) -> None:
    two.append(episode_of("p", info=replace(INFO, index=2), side_px=5))
    with pytest.raises(SheathError, match="top 5x5 instead of top 4x4: a file"):
        export(two, tmp_path / "out", form, Selection())
    assert not (tmp_path / "out").exists()


def test_minari_loads_it_with_all_observations(two, tmp_path: Path, monkeypatch) -> None:
    minari = pytest.importorskip("minari")
    export(two, tmp_path / "demos-v0", "minari", Selection())
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    dataset = minari.load_dataset("demos-v0")
    assert (dataset.total_episodes, dataset.total_steps) == (2, 4)
    stored = two.read(two.names()[0])
    episode = dataset[0]
    assert episode.observations["image_top"].shape == (3, 4, 4, 3)
    last = stored.final_observation.images["top"]
    assert episode.observations["image_top"][-1].tobytes() == last.tobytes()
    assert episode.terminations.tolist() == [False, True]
    assert episode.truncations.tolist() == [False, False]
    assert episode.infos["intervention"].tolist() == [False, True]
