"""Dropping episodes by name, and repairing what a crash or a hand left."""

import os
import shutil
import time
from dataclasses import replace

import pytest

from sheath_manip.dataset.check import check
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.repair import Repaired, repair
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from tests.dataset.folders import repacked, unpacked
from tests.episodes import INFO, episode_of
from tools.identical import identical

OLD_S = 10_000.0


def age(path) -> None:
    """As if nobody had written there for a long while."""
    then = time.time() - OLD_S
    for each in (*path.rglob("*"), path):
        os.utime(each, (then, then), follow_symlinks=False)


@pytest.fixture
def names(store: EpisodeStore) -> list[str]:
    for index in range(3):
        store.append(episode_of("pe", info=replace(INFO, index=index)))
    return store.names()


class TestDrop:
    def test_one_goes_and_the_others_stay(self, store, names) -> None:
        before = store.read(names[2])
        store.drop(names[1])
        assert store.names() == [names[0], names[2]]
        assert identical(store.read(names[2]), before)
        assert check(store) == []

    def test_a_damaged_one_goes_too(self, store, names) -> None:
        inside = unpacked(store, names[0])
        (inside / "zarr.json").unlink()
        repacked(inside)
        store.drop(names[0])
        assert store.names() == names[1:]

    @pytest.mark.parametrize("name", ["", ".", "..", "../store", "learning-s0-r00-i009-seed7", "x"])
    def test_only_what_is_named_in_full(self, store, names, name) -> None:
        (store.path / "x").mkdir()
        with pytest.raises(StoreError, match="has no episode"):
            store.drop(name)
        assert store.names() == names
        assert (store.path / "x").exists()

    def test_a_crash_on_the_way_is_out_of_sight(self, store, names, monkeypatch) -> None:
        unpacked(store, names[0])
        monkeypatch.setattr(shutil, "rmtree", lambda _: (_ for _ in ()).throw(OSError("gone")))
        with pytest.raises(StoreError, match=f"cannot drop {names[0]}"):
            store.drop(names[0])
        monkeypatch.undo()
        assert store.names() == names[1:]
        assert [fault.damaging for fault in check(store)] == [False]
        assert len(repair(store, idle_s=0).swept) == 1
        assert check(store) == []

    def test_it_may_be_recorded_again(self, store, names) -> None:
        store.drop(names[0])
        assert store.append(episode_of("pep", info=replace(INFO, index=0))) == names[0]


class TestRepair:
    def test_a_sound_store_stays_as_it_is(self, store, names) -> None:
        assert repair(store, idle_s=0) == Repaired((), (), ())
        assert store.names() == names

    def test_leftovers_go_when_nobody_writes_to_them(self, store, names) -> None:
        old, new = store.path / ".tmp-old", store.path / ".tmp-new"
        inside = unpacked(store, names[0])
        shutil.copytree(inside, old)
        age(old)
        (store.path / ".tmp-file").touch()
        age(store.path / ".tmp-file")
        new.mkdir()
        # Its folder is old, but a chunk was written just now.
        busy = shutil.copytree(inside, store.path / ".tmp-busy")
        age(busy)
        (busy / "score" / "c.0").touch()
        done = repair(store, idle_s=600)
        assert done.swept == (".tmp-file", ".tmp-old")
        assert done.waiting == (".tmp-busy", ".tmp-new")
        assert store.names() == names
        assert repair(store, idle_s=0).swept == (".tmp-busy", ".tmp-new")

    def test_a_misnamed_episode_has_its_name_again(self, store, names) -> None:
        episode = store.read(names[0])
        other = episode_name(replace(INFO, index=77))
        archive_path(store.path, names[0]).rename(archive_path(store.path, other))
        assert repair(store, idle_s=0).renamed == (names[0],)
        assert identical(store.read(names[0]), episode)
        assert check(store) == []

    def test_a_name_that_is_taken_is_not_given_twice(self, store, names) -> None:
        other = episode_name(replace(INFO, index=77))
        shutil.copy(archive_path(store.path, names[0]), archive_path(store.path, other))
        assert repair(store, idle_s=0).renamed == ()
        assert store.names() == [*names, other]
        assert [fault.name for fault in check(store)] == [other]

    def test_what_is_damaged_or_strange_stays(self, store, names) -> None:
        (unpacked(store, names[0]) / "zarr.json").write_text("{")
        (store.path / "notes.txt").write_text("mine")
        assert repair(store, idle_s=0) == Repaired((), (), ())
        assert store.names() == names
        assert (store.path / "notes.txt").read_text() == "mine"

    @pytest.mark.parametrize("idle_s", [-1, float("nan")])
    def test_a_time_that_is_none_sweeps_nothing(self, store, idle_s) -> None:
        (store.path / ".tmp-1").mkdir()
        with pytest.raises(ParameterError, match="wanted 0 or more"):
            repair(store, idle_s)
        assert (store.path / ".tmp-1").exists()
