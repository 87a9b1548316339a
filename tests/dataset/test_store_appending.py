"""An episode is appended whole and once, or it is refused and nothing is left of it."""

import errno
import os
import stat
import threading
from collections import namedtuple
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset import store as store_module
from sheath_manip.dataset.archive import give_name
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.protocols import Listener
from tests.dataset.tiny_episodes import INFO, entries, tiny
from tests.waiting import DEADLINE_S
from tools.identical import identical
from tools.synthetic import synthetic_episode


class TestAppending:
    def test_a_name_is_never_overwritten(self, store: EpisodeStore) -> None:
        first, second = tiny(INFO), synthetic_episode(INFO, length=3, pixels=2)
        name = store.append(first)
        with pytest.raises(StoreError, match=f"already holds {name}, and it is kept"):
            store.append(second)
        assert identical(store.read(name), first)
        assert entries(store) == [name, "sheath-store.json"]

    def test_of_two_that_race_one_wins(
        self, store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        barrier = threading.Barrier(2)

        def name_together(archive: Path, final: Path) -> None:
            barrier.wait(DEADLINE_S)
            give_name(archive, final)

        monkeypatch.setattr(store_module, "give_name", name_together)
        episode, lines = tiny(INFO), []

        def append() -> None:
            try:
                store.append(episode)
            except StoreError as error:
                lines.append(str(error))

        threads = [threading.Thread(target=append) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(lines) == 1
        assert "already holds" in lines[0]
        assert entries(store) == [episode_name(INFO), "sheath-store.json"]
        assert identical(store.read(episode_name(INFO)), episode)

    def test_an_episode_of_another_run_is_not_taken_for_this_one(self, store: EpisodeStore) -> None:
        store.append(tiny(INFO))
        assert store.has(INFO)
        assert not store.has(replace(INFO, index=8))
        with pytest.raises(StoreError, match="another run: checkpoint '' instead of 'abc'"):
            store.has(replace(INFO, checkpoint="abc"))

    def test_a_failed_write_leaves_nothing(
        self, store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        def fail(*_: object) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(store_module, "write_archive", fail)
        with pytest.raises(StoreError, match="No space left"):
            store.append(tiny(INFO))
        assert entries(store) == ["sheath-store.json"]

    def test_a_nearly_full_disk_is_refused_before_writing(
        self, store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        name = store.append(tiny(INFO))
        usage = namedtuple("usage", "total used free")(10**12, 10**12, 10**8)
        monkeypatch.setattr("shutil.disk_usage", lambda _: usage)
        with pytest.raises(StoreError, match="100 MB free, wanted 200 MB"):
            store.append(tiny(replace(INFO, index=8)))
        assert entries(store) == [name, "sheath-store.json"]

    def test_all_is_on_the_disk_before_the_name_is(
        self, store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        synced: list[int] = []

        def fsync(descriptor: int) -> None:
            status = os.fstat(descriptor)
            if not stat.S_ISDIR(status.st_mode):
                assert store.names() == []
                synced.append(status.st_size)

        monkeypatch.setattr(os, "fsync", fsync)
        name = store.append(tiny(INFO))
        assert synced[0] == archive_path(store.path, name).stat().st_size

        def broken(_: int) -> None:
            raise OSError(errno.EIO, "Input/output error")

        monkeypatch.setattr(os, "fsync", broken)
        with pytest.raises(StoreError, match="Input/output error"):
            store.append(tiny(replace(INFO, index=8)))
        assert entries(store) == [name, "sheath-store.json"]

    @pytest.mark.parametrize(
        ("change", "message"),
        [
            ({"executed": np.array([np.nan, 0], np.float32)}, "'executed' is not finite"),
            ({"labelled": np.array([0, np.inf], np.float32)}, "'labelled' is not finite"),
            ({"executed": np.zeros(2)}, r"executed is float64 \(2, 2\); wanted float32"),
            ({"state": np.zeros(1)}, "different shapes"),
        ],
    )
    def test_a_bad_step_is_refused(
        self, store: EpisodeStore, change: dict[str, np.ndarray], message: str
    ) -> None:
        good = tiny(INFO)
        bad = replace(good, steps=(good.steps[0], replace(good.steps[1], **change)))
        with pytest.raises(StoreError, match=message):
            Recorder(store).on_end(bad)
        assert entries(store) == ["sheath-store.json"]

    def test_an_empty_episode_and_odd_cameras_are_refused(self, store: EpisodeStore) -> None:
        good = tiny(INFO)
        with pytest.raises(StoreError, match="at least one step"):
            store.append(replace(good, steps=()))
        seen = replace(good.final_observation, images={"a/b": np.zeros((2, 2, 3), np.uint8)})
        with pytest.raises(StoreError, match="camera name"):
            store.append(replace(good, final_observation=seen))
        seen = replace(good.final_observation, images={})
        with pytest.raises(StoreError, match="in every step, one has"):
            store.append(replace(good, final_observation=seen))

    def test_a_method_too_long_for_a_directory_is_refused(self, store: EpisodeStore) -> None:
        info = replace(INFO, method="β" * 50)
        with pytest.raises(StoreError, match="choose a shorter one"):
            store.append(tiny(info))
        with pytest.raises(StoreError, match="choose a shorter one"):
            store.has(info)

    def test_the_recorder_is_a_listener(self, store: EpisodeStore) -> None:
        recorder: Listener = Recorder(store)
        recorder.on_end(tiny(INFO))
        assert store.has(INFO)
