"""Several stores into one, one into several: copied to the byte, and all or nothing."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.dataset.check import check
from sheath_manip.dataset.merging import Merged, merge, split
from sheath_manip.dataset.naming import LEFTOVER_PREFIX
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.seeding import generator
from tests.episodes import INFO, episode_of


def filled(path: Path, indices: Sequence[int], actors: str = "pe", task: str = "toy"):
    store = EpisodeStore.create(path)
    for index in indices:
        store.append(episode_of(actors, info=replace(INFO, task=task, index=index)))
    return store


def contents(store: EpisodeStore) -> dict[str, bytes]:
    return {
        f"{name}/{file}": store.content(name, file)
        for name in store.names()
        for file in store.files(name)
    }


def test_all_episodes_of_all_stores_to_the_byte(tmp_path: Path) -> None:
    first, second = filled(tmp_path / "a", [0, 1]), filled(tmp_path / "b", [2])
    target = filled(tmp_path / "c", [3])
    before, told = contents(target), []
    assert merge([first, second], target, told.append) == Merged(3, 0)
    assert contents(target) == before | contents(first) | contents(second)
    assert told == first.names() + second.names()
    assert check(target) == []
    assert merge([first, second], target) == Merged(0, 3)
    # A store into itself changes nothing.
    assert merge([EpisodeStore(target.path)], target) == Merged(0, 4)


def test_the_same_episode_of_two_sources_is_copied_once(tmp_path: Path) -> None:
    first = filled(tmp_path / "a", [0])
    merge([first], EpisodeStore.create(tmp_path / "b"))
    done = merge([first, EpisodeStore(tmp_path / "b")], EpisodeStore.create(tmp_path / "c"))
    assert done == Merged(1, 1)


@pytest.mark.parametrize("where", ["source", "target"])
def test_two_episodes_of_one_name_stop_it_before_anything_is_copied(tmp_path, where) -> None:
    one, other = filled(tmp_path / "a", [0, 1]), filled(tmp_path / "b", [1], actors="pep")
    target = other if where == "target" else EpisodeStore.create(tmp_path / "c")
    before = contents(target)
    with pytest.raises(StoreError, match=r"hold different episodes .* both are kept"):
        merge([one, other], target)
    assert contents(target) == before


def test_one_store_holds_one_task(tmp_path: Path) -> None:
    target = filled(tmp_path / "c", [3])
    with pytest.raises(StoreError, match="of task 'moon', others are of 'toy'"):
        merge([filled(tmp_path / "a", [0], task="moon")], target)
    assert len(target.names()) == 1


def test_a_damaged_episode_stops_it(tmp_path: Path) -> None:
    sources = [filled(tmp_path / "a", [0]), filled(tmp_path / "b", [1])]
    (sources[1].path / sources[1].names()[0] / "state" / "c.0.0").unlink()
    target = EpisodeStore.create(tmp_path / "c")
    with pytest.raises(StoreError, match="state has 0 of 1 chunks"):
        merge(sources, target)
    assert target.names() == []


def test_a_merge_that_was_cut_off_is_run_again(tmp_path: Path) -> None:
    source, target = filled(tmp_path / "a", range(3)), EpisodeStore.create(tmp_path / "b")

    def interrupt(_: str) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        merge([source], target, interrupt)
    assert len(target.names()) == 1
    assert merge([source], target) == Merged(2, 1)
    assert contents(target) == contents(source)


class TestSplit:
    def test_each_episode_is_in_one_part(self, tmp_path: Path) -> None:
        store = filled(tmp_path / "a", range(10))
        shares = {"train": 0.7, "test": 0.2, "rest": 0.1}
        drawn = split(store, shares, tmp_path / "parts", generator("split", 0))
        assert [len(names) for names in drawn.values()] == [7, 2, 1]
        parts = [EpisodeStore(tmp_path / "parts" / part) for part in shares]
        assert sorted(name for part in parts for name in part.names()) == store.names()
        joined = {file: content for part in parts for file, content in contents(part).items()}
        assert joined == contents(store)
        assert [part.names() for part in parts] == list(drawn.values())

    def test_the_seed_decides(self, tmp_path: Path) -> None:
        store = filled(tmp_path / "a", range(10))
        draws = [
            split(store, {"x": 0.5, "y": 0.5}, tmp_path / name, generator("split", seed))
            for name, seed in (("p", 3), ("q", 3), ("r", 4))
        ]
        assert draws[0] == draws[1] != draws[2]

    @pytest.mark.parametrize(
        ("parts", "message"),
        [
            ({}, "add up to 1"),
            ({"a": 0.5}, "add up to 1"),
            ({"a": 1.5, "b": -0.5}, "wanted positive ones"),
            ({"a": float("nan")}, "add up to 1"),
            ({"a": 0.99, "b": 0.01}, "has 3 episodes, too few"),
            ({"../a": 1.0}, "is no plain name"),
            ({".a": 1.0}, "is no plain name"),
            ({"": 1.0}, "is no plain name"),
        ],
    )
    def test_parts_that_make_no_sense(self, tmp_path: Path, parts, message) -> None:
        store = filled(tmp_path / "a", range(3))
        with pytest.raises(ParameterError, match=message):
            split(store, parts, tmp_path / "parts", generator("split", 0))
        assert [path.name for path in tmp_path.iterdir()] == ["a"]

    def test_what_is_there_is_kept(self, tmp_path: Path) -> None:
        store = filled(tmp_path / "a", [0])
        (tmp_path / "parts").mkdir()
        with pytest.raises(StoreError, match="exists, and it is kept"):
            split(store, {"all": 1.0}, tmp_path / "parts", generator("split", 0))
        assert list((tmp_path / "parts").iterdir()) == []

    def test_a_damaged_episode_leaves_nothing(self, tmp_path: Path) -> None:
        store = filled(tmp_path / "a", range(2))
        (store.path / store.names()[1] / "state" / "c.0.0").unlink()
        with pytest.raises(StoreError, match="state has 0 of 1 chunks"):
            split(store, {"x": 0.5, "y": 0.5}, tmp_path / "parts", generator("split", 0))
        assert [p.name for p in tmp_path.iterdir() if p.name != "a"] == []
        assert not list(tmp_path.rglob(f"{LEFTOVER_PREFIX}*"))
