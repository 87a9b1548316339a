"""The index of a store makes listing quick, and is never trusted over the episodes."""

import json
import os
import shutil
import threading
import zlib
from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.dataset.check import check
from sheath_manip.dataset.index import INDEX
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.reader import EpisodeReader, EpisodeSummary
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Outcome
from tests.dataset.folders import unpacked
from tests.dataset.tiny_episodes import INFO, tiny
from tests.episodes import episode_of


def filled(store: EpisodeStore, count: int = 4) -> list[str]:
    return [store.append(tiny(replace(INFO, index=index))) for index in range(count)]


def opened(store: EpisodeStore) -> list[EpisodeSummary]:
    """All at a glance, each asked for by itself."""
    return [store.summary(name) for name in store.names()]


@pytest.fixture
def headers_read(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of the episodes whose header a listing read."""
    read: list[str] = []
    whole = EpisodeReader.unmarked_summary

    def counted(self: EpisodeReader, name: str) -> EpisodeSummary:
        read.append(name)
        return whole(self, name)

    monkeypatch.setattr(EpisodeReader, "unmarked_summary", counted)
    return read


def test_what_was_written_is_listed_without_being_opened(
    store: EpisodeStore, headers_read: list[str]
) -> None:
    filled(store)
    expected = opened(store)
    headers_read.clear()
    assert EpisodeStore(store.path).infos() == expected
    assert headers_read == []
    assert check(store) == []


def test_metrics_that_are_no_numbers_and_marks_are_told(store: EpisodeStore) -> None:
    name = store.append(replace(tiny(INFO), metrics={"a": float("inf"), "b": float("-inf")}))
    store.mark(name, Marks(Outcome.FAILURE, ((0, 1),)))
    (summary,) = EpisodeStore(store.path).infos()
    assert summary == store.summary(name)
    assert (summary.outcome, summary.bad_steps) == (Outcome.FAILURE, 1)
    store.mark(name, Marks())
    assert EpisodeStore(store.path).infos()[0].bad_steps == 0


def test_without_an_index_it_is_made(store: EpisodeStore, headers_read: list[str]) -> None:
    names = filled(store)
    expected = opened(store)
    (store.path / INDEX).unlink()
    headers_read.clear()
    assert store.infos() == expected
    assert headers_read == sorted(names)
    headers_read.clear()
    assert EpisodeStore(store.path).infos() == expected
    assert headers_read == []


@pytest.mark.parametrize(
    "spoil",
    [
        lambda content: content[:-9],
        lambda content: content[: len(content) // 2],
        lambda _: b"",
        lambda _: b"\0" * 100,
        lambda content: content.replace(b"time-limit", b"success   "),
        lambda content: content + b"\n" + _line([1]) + b"\n" + _line({"x": 1}) + b"\n" + _line(7),
        lambda content: content + b"\n" + _checked(b"no JSON") + b"\n" + _checked(b"1],[2"),
        lambda content: content + b"\n" + b"[" * 100_000,
    ],
)
def test_a_torn_or_changed_one_changes_nothing(store: EpisodeStore, spoil) -> None:
    filled(store)
    expected = opened(store)
    (store.path / INDEX).write_bytes(spoil((store.path / INDEX).read_bytes()))
    for _ in range(2):
        assert EpisodeStore(store.path).infos() == expected


def _line(told: object) -> bytes:
    text = json.dumps(told).encode()
    return _checked(text)


def _checked(text: bytes) -> bytes:
    return f"{zlib.crc32(text):08x} ".encode() + text


def test_another_file_under_the_name_is_opened(store: EpisodeStore, tmp_path: Path) -> None:
    names = filled(store)
    other = EpisodeStore.create(tmp_path / "other")
    other.append(replace(episode_of("peppe", info=replace(INFO, index=1)), metrics={"m": 7.0}))
    shutil.copy(archive_path(other.path, names[1]), archive_path(store.path, names[1]))
    assert EpisodeStore(store.path).infos() == opened(store)
    assert EpisodeStore(store.path).infos()[1].metrics == {"m": 7.0}
    store.drop(names[0])
    assert [each.name for each in EpisodeStore(store.path).infos()] == names[1:]


def test_a_lie_about_another_machine_s_file_is_not_believed(
    store: EpisodeStore, tmp_path: Path
) -> None:
    filled(store)
    expected = opened(store)
    # As unpacked from somebody: times and sizes are as they were there.
    moved = Path(shutil.copytree(store.path, tmp_path / "moved", copy_function=shutil.copy2))
    lines = (moved / INDEX).read_bytes().split(b"\n")
    lies = [_line(json.loads(line[9:].replace(b"time-limit", b"success"))) for line in lines[1:]]
    (moved / INDEX).write_bytes(b"\n".join(lies))
    assert [each.outcome for each in EpisodeStore(moved).infos()] == [
        each.outcome for each in expected
    ]


def test_a_damaged_episode_is_told_of_and_the_others_listed(store: EpisodeStore) -> None:
    names = filled(store)
    archive_path(store.path, names[2]).write_bytes(b"")
    found = list(EpisodeStore(store.path).summaries())
    assert [isinstance(each, StoreError) for each in found] == [False, False, True, False]
    with pytest.raises(StoreError, match=names[2]):
        store.infos()


def test_two_write_at_once(store: EpisodeStore, headers_read: list[str]) -> None:
    def append(method: str) -> None:
        own = EpisodeStore(store.path)
        for index in range(8):
            own.append(tiny(replace(INFO, method=method, index=index)))

    threads = [threading.Thread(target=append, args=(method,)) for method in ("a", "b")]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expected = opened(store)
    headers_read.clear()
    assert EpisodeStore(store.path).infos() == expected
    assert len(expected) == 16
    assert headers_read == []


def test_lines_that_no_longer_count_go(
    store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = filled(store)
    monkeypatch.setattr("sheath_manip.dataset.index._FEW", 2)
    for _ in range(3):
        store.drop(names[0])
        store.append(tiny(replace(INFO, index=0)))
    for name in names:
        os.utime(archive_path(store.path, name))
    expected = opened(store)
    for _ in range(4):
        assert EpisodeStore(store.path).infos() == expected
    assert len((store.path / INDEX).read_bytes().split(b"\n")) <= 2 * len(names) + 3


def test_where_it_cannot_be_written_all_is_listed(store: EpisodeStore) -> None:
    filled(store)
    (store.path / INDEX).unlink()
    (store.path / INDEX).mkdir()
    assert EpisodeStore(store.path).infos() == opened(store)
    assert [fault.name for fault in check(store)] == []


def test_folders_are_opened_each_time(store: EpisodeStore, headers_read: list[str]) -> None:
    names = filled(store)
    unpacked(store, names[0])
    expected = opened(store)
    headers_read.clear()
    assert EpisodeStore(store.path).infos() == expected
    assert headers_read == [names[0]]
