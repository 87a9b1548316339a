"""Training states mapped from files that are built once per set of episodes."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset.mapped import mapped_once, mapped_samples
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.types.samples import Samples, samples_from
from tests.dataset.folders import unpacked
from tests.dataset.generated import of_task
from tests.episodes import INFO, episode_of


def same(a: Samples, b: Samples) -> bool:
    def arrays(samples: Samples):
        columns = (samples.labels, samples.episodes, samples.steps, samples.actors)
        return {**samples.images, "f": samples.features, **dict(enumerate(columns))}

    ours, theirs = arrays(a), arrays(b)
    return ours.keys() == theirs.keys() and all(
        (x.dtype, x.shape, x.tobytes()) == (y.dtype, y.shape, y.tobytes())
        for x, y in zip(ours.values(), theirs.values(), strict=True)
    )


@pytest.fixture
def cache(tmp_path: Path) -> Path:
    return tmp_path / "cache"


@pytest.fixture
def filled(store: EpisodeStore) -> EpisodeStore:
    for index, actors in enumerate(("pee", "ep", "ppe")):
        store.append(episode_of(actors, info=replace(INFO, index=index), side_px=4))
    return store


@pytest.mark.parametrize("task", ["corridor", "driving", "platformer", "grasp-clutter"])
def test_they_are_what_memory_would_hold(store, specs, cache, task) -> None:
    for episode in of_task(specs[task], seed=4, count=3, longest=8):
        store.append(episode)
    mapped = mapped_samples(store, store.names(), cache)
    assert same(mapped, samples_from(store.read_many(store.names())))


def test_they_are_built_once_for_the_same_episodes(filled, cache, monkeypatch) -> None:
    first = mapped_samples(filled, filled.names(), cache)
    with monkeypatch.context() as patch:
        patch.setattr(EpisodeStore, "array", None)
        assert same(mapped_samples(filled, filled.names(), cache), first)
    assert len(list(cache.iterdir())) == 1
    fewer = mapped_samples(filled, filled.names()[:2], cache)
    assert len(fewer) == 3
    assert len(list(cache.iterdir())) == 2


def test_where_they_are_not_kept_nothing_is_left(filled, tmp_path) -> None:
    once = mapped_once(filled, filled.names(), tmp_path / "runs" / "checkpoint.npz")
    assert same(once, samples_from(filled.read_many(filled.names())))
    assert list((tmp_path / "runs").iterdir()) == []
    with pytest.raises(ParameterError, match="no labelled state"):
        mapped_once(filled, [], tmp_path / "runs" / "checkpoint.npz")
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="cannot keep the training states"):
        mapped_once(filled, filled.names(), tmp_path / "file" / "checkpoint.npz")
    assert list((tmp_path / "runs").iterdir()) == []


def test_an_episode_recorded_anew_is_another(filled, cache) -> None:
    before = mapped_samples(filled, filled.names(), cache)
    name = filled.names()[0]
    filled.drop(name)
    filled.append(episode_of("eeeee", info=replace(INFO, index=0), side_px=4))
    after = mapped_samples(filled, filled.names(), cache)
    assert (len(before), len(after)) == (4, 7)


def test_what_is_changed_in_memory_is_not_in_the_files(filled, cache) -> None:
    samples = mapped_samples(filled, filled.names(), cache)
    samples.features[:] = 7
    samples.images["top"][:] = 7
    again = mapped_samples(filled, filled.names(), cache)
    assert same(again, samples_from(filled.read_many(filled.names())))


def test_frames_are_drawn_at_random(filled, cache) -> None:
    samples = mapped_samples(filled, filled.names(), cache)
    drawn = samples.take(np.array([3, 0, 3]))
    whole = samples_from(filled.read_many(filled.names()))
    assert same(drawn, whole.take(np.array([3, 0, 3])))


def test_no_label_no_training(store, cache) -> None:
    store.append(episode_of("pp"))
    with pytest.raises(ParameterError, match="no labelled state"):
        mapped_samples(store, store.names(), cache)
    assert not cache.exists()


def test_a_damaged_episode_leaves_no_files(filled, cache) -> None:
    (unpacked(filled, filled.names()[1]) / "images" / "top" / "c.0.0.0.0").write_bytes(b"x")
    with pytest.raises(StoreError, match="images/top does not decode"):
        mapped_samples(filled, filled.names(), cache)
    assert list(cache.iterdir()) == []


def test_broken_files_are_one_line(filled, cache) -> None:
    mapped_samples(filled, filled.names(), cache)
    (directory,) = cache.iterdir()
    file = directory / "labels.npy"
    file.write_bytes(file.read_bytes()[:-3])
    with pytest.raises(StoreError, match=r"does not decode .* delete it, it is made anew"):
        mapped_samples(filled, filled.names(), cache)
    file.unlink()
    with pytest.raises(StoreError, match="delete it"):
        mapped_samples(filled, filled.names(), cache)


def test_a_place_that_cannot_be_written_is_one_line(filled, tmp_path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="cannot write"):
        mapped_samples(filled, filled.names(), tmp_path / "file")


def test_episodes_of_other_shapes_are_refused(filled, cache) -> None:
    filled.append(episode_of("e", info=replace(INFO, index=9), side_px=6))
    with pytest.raises(StoreError, match="episodes that are alike"):
        mapped_samples(filled, filled.names(), cache)
    assert list(cache.iterdir()) == []
