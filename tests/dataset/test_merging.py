"""Several stores into one, one into several: copied to the byte, and all or nothing."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.dataset.check import check
from sheath_manip.dataset.content import content_digest
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.merging import Merged, merge, split
from sheath_manip.dataset.naming import LEFTOVER_PREFIX
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.sessions import new_session
from sheath_manip.dataset.space import Space
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.seeding import generator
from sheath_manip.types import Outcome
from tests.dataset.folders import unpacked
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


SPACE = Space(("x_m",), ("push_n",), (-1.0,), (1.0,), None)


class TestByHand:
    """Recordings of the same scenes, made twice: none of them may be lost."""

    def recorded(self, path: Path, session: str, actors: str) -> EpisodeStore:
        store = EpisodeStore.create(path)
        for index in (0, 1):
            info = replace(INFO, method="person", index=index, session=session)
            store.append(episode_of(actors, info=info), SPACE)
        return store

    def test_sessions_of_two_days_unite(self, tmp_path: Path) -> None:
        monday = self.recorded(tmp_path / "monday", new_session(), "eee")
        friday = self.recorded(tmp_path / "friday", new_session(), "ee")
        target = EpisodeStore.create(tmp_path / "all")
        assert merge([monday, friday], target) == Merged(4, 0)
        assert contents(target) == contents(monday) | contents(friday)
        assert sorted(len(target.read(name)) for name in target.names()) == [2, 2, 3, 3]
        assert check(target) == []

    def test_old_sessions_without_a_name_unite_too(self, tmp_path: Path) -> None:
        monday = self.recorded(tmp_path / "monday", "", "eee")
        friday = self.recorded(tmp_path / "friday", "", "ee")
        friday.mark(friday.names()[0], Marks(Outcome.FAILURE))
        assert monday.names() == friday.names()
        target = EpisodeStore.create(tmp_path / "all")
        done = merge([monday, friday], target)
        assert (done.copied, done.held, len(done.renamed)) == (4, 0, 2)
        assert sorted(len(target.read(name)) for name in target.names()) == [2, 2, 3, 3]
        # Only the header of what has another name is another, and marks go with it.
        there = contents(target)
        assert {name for name, content in contents(monday).items() if there[name] != content} == (
            set()
        )
        for old, new in zip(friday.names(), done.renamed, strict=True):
            files = friday.files(old)
            differing = {f for f in files if friday.content(old, f) != target.content(new, f)}
            assert differing == {"zarr.json"}
            assert target.marks(new) == friday.marks(old)
            assert target.header(new).recorded_utc == friday.header(old).recorded_utc
        assert check(target) == []

    def test_it_is_done_once_in_whatever_order(self, tmp_path: Path) -> None:
        monday = self.recorded(tmp_path / "monday", "", "eee")
        friday = self.recorded(tmp_path / "friday", "", "ee")
        one, other = (EpisodeStore.create(tmp_path / name) for name in ("one", "other"))
        merge([monday, friday], one)
        merge([friday, monday], other)
        for source in (monday, friday):
            assert merge([source], one) == Merged(0, 2)
        assert merge([one], other) == Merged(0, 4)

    def test_one_of_the_target_stays(self, tmp_path: Path) -> None:
        target = self.recorded(tmp_path / "monday", "", "eee")
        before = contents(target)
        done = merge([self.recorded(tmp_path / "friday", "", "ee")], target)
        assert contents(target).items() >= before.items()
        assert len(target.names()) == 4
        assert set(done.renamed) == set(target.names()) - {name.split("/")[0] for name in before}


def test_marks_reach_episodes_that_were_there_before(tmp_path: Path) -> None:
    source, again = filled(tmp_path / "a", [0, 1]), filled(tmp_path / "b", [0, 1])
    first, second = source.names()
    target = EpisodeStore.create(tmp_path / "c")
    merge([source], target)
    # Marked after the merge, or by a merge that was cut off before it came to the marks.
    source.mark(first, Marks(bad=((0, 1),)))
    assert merge([source], target) == Merged(0, 2)
    assert target.marks(first) == source.marks(first)
    assert target.marks(second) == Marks()
    # Of two sources with the same episodes the second may be the marked one.
    new = EpisodeStore.create(tmp_path / "d")
    assert merge([again, source], new) == Merged(2, 2)
    assert new.marks(first) == source.marks(first)
    # What was said in the target stays, and it is told.
    target.mark(first, Marks(Outcome.FAILURE))
    (told,) = (each for each in merge([source], target).remarks if "marked" in each)
    assert told.startswith(f"{first} is marked otherwise in {source.address}")
    assert target.marks(first) == Marks(Outcome.FAILURE)


def test_equal_content_is_the_same_whenever_it_was_written(tmp_path: Path) -> None:
    first, second = filled(tmp_path / "a", [0]), EpisodeStore.create(tmp_path / "b")
    (name,) = first.names()
    recorded = first.recorded(name)
    header = replace(recorded.header, recorded_utc="2020-01-01T00:00:00+00:00", space=SPACE)
    second.append_arrays(Recorded(header, recorded.arrays))
    assert contents(first) != contents(second)
    assert content_digest(first, name) == content_digest(second, name)
    target = EpisodeStore.create(tmp_path / "c")
    assert merge([first, second], target) == Merged(1, 1)


def test_variants_of_one_task_are_named(tmp_path: Path) -> None:
    store = EpisodeStore.create(tmp_path / "a")
    for index, variant in enumerate(("default", "windy", "windy")):
        info = replace(INFO, index=index, variant=variant)
        store.append(episode_of("pe", info=info), SPACE)
    done = merge([store], EpisodeStore.create(tmp_path / "b"))
    assert done.remarks == ("episodes of several variants: 1 of 'default', 2 of 'windy'",)


def test_what_differs_is_refused_before_anything_is_copied(tmp_path: Path) -> None:
    store, other = filled(tmp_path / "a", [0, 1]), EpisodeStore.create(tmp_path / "b")
    other.append(episode_of("pe", info=replace(INFO, index=2, control_rate_hz=24.0)))
    target = EpisodeStore.create(tmp_path / "c")
    with pytest.raises(StoreError, match=r"control rate 24 Hz instead of 10 Hz: .*nothing was"):
        merge([store, other], target)
    assert target.names() == []


def test_one_store_holds_one_task(tmp_path: Path) -> None:
    target = filled(tmp_path / "c", [3])
    with pytest.raises(StoreError, match="task 'moon' instead of 'toy'"):
        merge([filled(tmp_path / "a", [0], task="moon")], target)
    assert len(target.names()) == 1


def test_a_damaged_episode_stops_it(tmp_path: Path) -> None:
    sources = [filled(tmp_path / "a", [0]), filled(tmp_path / "b", [1])]
    (unpacked(sources[1], sources[1].names()[0]) / "state" / "c.0.0").unlink()
    target = EpisodeStore.create(tmp_path / "c")
    with pytest.raises(StoreError, match=r"state/c\.0\.0 is missing"):
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

    def test_a_scene_is_in_one_part_however_often_it_was_recorded(self, tmp_path: Path) -> None:
        sources = [filled(tmp_path / "a", range(8))]
        for name, actors in (("b", "eee"), ("c", "eeee")):
            again = EpisodeStore.create(tmp_path / name)
            for index in range(8):
                info = replace(INFO, index=index, session=new_session())
                again.append(episode_of(actors, info=info), SPACE)
            sources.append(again)
        store = EpisodeStore.create(tmp_path / "all")
        assert merge(sources, store).copied == 24
        drawn = split(store, {"x": 0.5, "y": 0.5}, tmp_path / "parts", generator("split", 3))
        scenes = [{store.header(name).info.index for name in names} for names in drawn.values()]
        assert not scenes[0] & scenes[1]
        assert [len(names) for names in drawn.values()] == [12, 12]

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
            ({"a": 0.99, "b": 0.01}, "of 3 scenes, too few"),
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
        (unpacked(store, store.names()[1]) / "state" / "c.0.0").unlink()
        with pytest.raises(StoreError, match=r"state/c\.0\.0 is missing"):
            split(store, {"x": 0.5, "y": 0.5}, tmp_path / "parts", generator("split", 0))
        assert [p.name for p in tmp_path.iterdir() if p.name != "a"] == []
        assert not list(tmp_path.rglob(f"{LEFTOVER_PREFIX}*"))
