import ctypes
import errno
import json
import shutil
import subprocess
import sys
import threading
from collections import namedtuple
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import zarr

from sheath_manip.dataset import durable
from sheath_manip.dataset import store as store_module
from sheath_manip.dataset.check import check
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.naming import episode_name, is_episode_name
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.protocols import Listener
from sheath_manip.types import Episode, EpisodeInfo, Limited, Purpose
from tests.waiting import DEADLINE_S
from tools.identical import identical
from tools.synthetic import synthetic_episode, synthetic_info

INFO = EpisodeInfo("driving", 12345, Purpose.LEARNING, 10.0, "sheath", round=3, index=7)


def tiny(info: EpisodeInfo) -> Episode:
    return synthetic_episode(info, length=2, pixels=2)


def entries(store: EpisodeStore) -> list[str]:
    return sorted(path.name for path in store.path.iterdir())


class TestNames:
    def test_a_name_says_where_the_episode_is_from(self) -> None:
        assert episode_name(INFO) == "learning-sheath-s0-r03-i007-seed12345"
        assert episode_name(replace(INFO, method="")) == "learning-s0-r03-i007-seed12345"

    @pytest.mark.parametrize("method", ["a/b", "../x", "β = 0.5", "a-s1-r00", "[red]"])
    def test_any_method_makes_a_plain_name(self, method: str) -> None:
        name = episode_name(replace(INFO, method=method))
        assert Path(name).name == name
        assert is_episode_name(name)

    @pytest.mark.parametrize("name", [".tmp-1", "notes", "learning", "playing-s0-r00-i000-seed1"])
    def test_other_entries_are_no_episodes(self, name: str) -> None:
        assert not is_episode_name(name)


class TestOpening:
    def test_create_makes_once_and_then_opens(self, tmp_path: Path) -> None:
        EpisodeStore.create(tmp_path / "a" / "b").append(tiny(INFO))
        assert len(EpisodeStore.create(tmp_path / "a" / "b").names()) == 1
        assert len(EpisodeStore(tmp_path / "a" / "b").names()) == 1

    def test_reading_wants_a_store(self, tmp_path: Path) -> None:
        with pytest.raises(StoreError, match="found nothing; give the directory"):
            EpisodeStore(tmp_path / "missing")
        assert not (tmp_path / "missing").exists()

    def test_a_foreign_directory_is_refused_and_left_alone(self, tmp_path: Path) -> None:
        (tmp_path / "thesis.tex").touch()
        for open_store in (EpisodeStore, EpisodeStore.create):
            with pytest.raises(
                StoreError, match=r"wanted an episode store at .*, found a directory"
            ):
                open_store(tmp_path)
        assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]

    def test_a_file_is_refused(self, tmp_path: Path) -> None:
        (tmp_path / "file").touch()
        with pytest.raises(StoreError, match="found a file"):
            EpisodeStore(tmp_path / "file")
        with pytest.raises(StoreError, match="choose a writable directory"):
            EpisodeStore.create(tmp_path / "file")

    @pytest.mark.parametrize(
        ("marker", "message"),
        [
            ('{"format": "sheath-store", "schema": 2}', "schema 2, wanted 1"),
            ('{"format": "other"}', "another format"),
            ("[]", "another format"),
            ("{", "does not decode"),
        ],
    )
    def test_another_marker_is_refused(
        self, store: EpisodeStore, marker: str, message: str
    ) -> None:
        (store.path / "sheath-store.json").write_text(marker)
        with pytest.raises(StoreError, match=message):
            EpisodeStore.create(store.path)

    def test_a_crash_while_making_the_store_is_no_obstacle(self, tmp_path: Path) -> None:
        (tmp_path / ".tmp-1").touch()
        assert EpisodeStore.create(tmp_path).names() == []


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

        def publish_together(*files_aside_final: Any) -> None:
            barrier.wait(DEADLINE_S)
            durable.publish_files(*files_aside_final)

        monkeypatch.setattr(store_module, "publish_files", publish_together)
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

        monkeypatch.setattr(store_module, "publish_files", fail)
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
        # As where there is no call for a whole file system.
        monkeypatch.setattr(durable, "_syncfs", None)
        synced: list[Path] = []
        monkeypatch.setattr(durable, "sync", synced.append)
        directory = store.path / store.append(tiny(INFO))
        *before, last = synced
        inside = {path.relative_to(directory) for path in directory.rglob("*")}
        assert {Path(*path.relative_to(store.path).parts[1:]) for path in before} == inside | {
            Path()
        }
        assert last == store.path

    def test_or_the_file_system_is_synced_before_the_name_is_there(
        self, store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        seen: list[set[str]] = []

        def syncfs(descriptor: int) -> int:
            aside = Path(f"/proc/self/fd/{descriptor}").readlink()
            seen.append({path.relative_to(aside).as_posix() for path in aside.rglob("*")})
            assert store.names() == []
            return 0

        monkeypatch.setattr(durable, "_syncfs", syncfs)
        name = store.append(tiny(INFO))
        directory = store.path / name
        assert seen == [{path.relative_to(directory).as_posix() for path in directory.rglob("*")}]

        def broken(_: int) -> int:
            ctypes.set_errno(errno.EIO)
            return -1

        monkeypatch.setattr(durable, "_syncfs", broken)
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


class TestReading:
    def test_summaries(self, store: EpisodeStore, episode: Episode) -> None:
        name = store.append(episode)
        (summary,) = store.infos()
        by_expert = [step.decision.actor == "expert" for step in episode.steps]
        assert (summary.name, summary.info, summary.length) == (name, episode.info, 70)
        assert summary.expert_share == np.mean(by_expert)
        assert summary.queries == sum(by_expert)
        assert summary.metrics == episode.metrics
        assert summary.bytes > 0

    def test_episodes_are_chosen_and_in_order(self, store: EpisodeStore) -> None:
        for round in (100, 2):
            for index in (1, 0):
                store.append(tiny(replace(INFO, round=round, index=index)))
        store.append(tiny(replace(INFO, purpose=Purpose.EVALUATION)))
        store.append(tiny(replace(INFO, method="dagger", run_seed=1)))
        chosen = store.episodes(Purpose.LEARNING, "sheath", need_images=False)
        assert [(e.info.round, e.info.index) for e in chosen] == [
            (2, 0),
            (2, 1),
            (100, 0),
            (100, 1),
        ]
        assert [e.info.index for e in store.episodes(round=2)] == [0, 1]
        assert [e.info.method for e in store.episodes(run_seed=1)] == ["dagger"]
        assert len(list(store.read_many(store.names()))) == 6

    @pytest.mark.parametrize("name", ["../store", "notes", episode_name(INFO)])
    def test_a_missing_name_is_one_line(self, store: EpisodeStore, name: str) -> None:
        (store.path / "notes").mkdir()
        with pytest.raises(StoreError, match="has no episode"):
            store.read(name)

    def test_an_intervention_needs_a_policy(self, store: EpisodeStore, episode: Episode) -> None:
        demonstration = replace(
            episode,
            info=replace(episode.info, purpose=Purpose.DEMONSTRATION),
            steps=tuple(replace(step, proposed=None) for step in episode.steps),
        )
        by_expert = [step.decision.actor == "expert" for step in episode.steps]

        def interventions(recorded: Episode) -> list[bool]:
            group = zarr.open_group(store.path / store.append(recorded), mode="r")
            array = group["intervention"]
            assert isinstance(array, zarr.Array)
            return np.asarray(array[:]).tolist()

        assert interventions(episode) == by_expert
        assert not any(interventions(demonstration))

    def test_a_reader_beside_a_writer_sees_whole_episodes_only(self, store: EpisodeStore) -> None:
        code = "import sys, pathlib, tools.kill_recorder as k; "
        code += "k.record_for_ever(pathlib.Path(sys.argv[1]), 0)"
        with subprocess.Popen(
            [sys.executable, "-c", code, str(store.path)], stdout=subprocess.DEVNULL
        ) as writer:
            try:
                seen: set[str] = set()
                while len(seen) < 5:
                    assert writer.poll() is None
                    for summary in store.infos():
                        if summary.name not in seen:
                            recorded = synthetic_episode(synthetic_info(0, summary.info.index))
                            assert identical(store.read(summary.name), recorded)
                            seen.add(summary.name)
            finally:
                writer.kill()
        assert not [fault for fault in check(store) if fault.damaging]


class TestLimits:
    def limited(self) -> Episode:
        episode = tiny(INFO)
        first, second = episode.steps
        changed = (Limited("joint velocity", 0.25), Limited("workspace", 1.5))
        return replace(episode, steps=(replace(first, limited=changed), second))

    def test_what_the_command_filter_changed_is_kept(self, store: EpisodeStore) -> None:
        name = store.append(self.limited())
        assert zarr.open_array(store.path / name, path="limited", mode="r").shape == (2, 2)
        first, second = store.read(name, need_images=False).steps
        assert first.limited == (Limited("joint velocity", 0.25), Limited("workspace", 1.5))
        assert second.limited == ()

    def test_an_episode_of_before_there_was_a_filter_opens(self, store: EpisodeStore) -> None:
        name = store.append(tiny(INFO))
        path = store.path / name / "zarr.json"
        header = json.loads(path.read_text())
        assert header["attributes"].pop("limits") == []
        path.write_text(json.dumps(header))
        assert not (store.path / name / "limited").exists()
        assert identical(store.read(name), tiny(INFO))
        assert check(store) == []

    def test_a_lost_array_of_limits_is_a_fault(self, store: EpisodeStore) -> None:
        name = store.append(self.limited())
        shutil.rmtree(store.path / name / "limited")
        assert [fault.kind for fault in check(store)] == [FaultKind.MISSING]
