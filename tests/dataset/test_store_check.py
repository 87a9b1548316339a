import json
import os
import shutil
from collections.abc import Callable
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import zarr
from rich.console import Console

from sheath_manip.dataset.check import check
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.table import print_check, print_list
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Episode
from tests.dataset.folders import repacked, unpacked
from tests.dataset.seals import unseal


def truncate_chunk(episode: Path) -> None:
    chunk = episode / "images" / "front" / "c.1.0.0.0"
    chunk.write_bytes(chunk.read_bytes()[:-20])


def flip_bit(episode: Path) -> None:
    chunk = episode / "images" / "front" / "c.0.0.0.0"
    data = bytearray(chunk.read_bytes())
    data[len(data) // 2] ^= 1
    chunk.write_bytes(data)


def delete_chunk(episode: Path) -> None:
    (episode / "executed" / "c.0.0").unlink()


def delete_array(episode: Path) -> None:
    shutil.rmtree(episode / "score")


def break_array_metadata(episode: Path) -> None:
    (episode / "score" / "zarr.json").write_text("{}")


def change_attribute(key: str, value: object) -> Callable[[Path], None]:
    def change(episode: Path) -> None:
        unseal(episode, lambda attributes: attributes.update({key: value}))

    return change


def set_value(path: str, value: float) -> Callable[[Path], None]:
    def change(episode: Path) -> None:
        array = zarr.open_group(episode, mode="r+")[path]
        assert isinstance(array, zarr.Array)
        array[0] = value

    return change


def as_before(change: Callable[[Path], None]) -> Callable[[Path], None]:
    """The same in an episode of before there were digests."""

    def changed(episode: Path) -> None:
        change(episode)
        unseal(episode)

    return changed


def without_digest(key: str) -> Callable[[Path], None]:
    def change(episode: Path) -> None:
        group = json.loads((episode / "zarr.json").read_text())
        del group["attributes"][key]
        (episode / "zarr.json").write_text(json.dumps(group))

    return change


def change_sealed(key: str, value: object) -> Callable[[Path], None]:
    def change(episode: Path) -> None:
        group = json.loads((episode / "zarr.json").read_text())
        group["attributes"][key] = value
        (episode / "zarr.json").write_text(json.dumps(group))

    return change


def truncate_header(episode: Path) -> None:
    (episode / "zarr.json").write_bytes((episode / "zarr.json").read_bytes()[:50])


def link(episode: Path) -> None:
    chunk = episode / "reward" / "c.0"
    chunk.rename(episode.parent / ".tmp-chunk")
    chunk.symlink_to(episode.parent / ".tmp-chunk")


def link_folder(episode: Path) -> None:
    (episode / "reward").rename(episode.parent / ".tmp-reward")
    (episode / "reward").symlink_to(episode.parent / ".tmp-reward")


def fifo(episode: Path) -> None:
    (episode / "reward" / "c.0").unlink()
    os.mkfifo(episode / "reward" / "c.0")


def grow(episode: Path) -> None:
    with (episode / "reward" / "c.0").open("r+b") as file:
        file.truncate(1 << 40)


def empty(episode: Path) -> None:
    shutil.rmtree(episode)
    episode.mkdir()


FAULTS = {
    "truncated chunk": (truncate_chunk, FaultKind.UNREADABLE, "images/front does not decode"),
    "changed bit": (flip_bit, FaultKind.UNREADABLE, "images/front does not decode"),
    "missing chunk": (delete_chunk, FaultKind.MISSING, "executed/c.0.0 is missing"),
    "missing array": (delete_array, FaultKind.MISSING, "the array score is missing"),
    "broken array": (break_array_metadata, FaultKind.UNREADABLE, "score does not decode"),
    "length": (change_attribute("length", 69), FaultKind.MISMATCH, r"front is uint8 \(70, .* \(69"),
    "no length": (
        change_attribute("length", 0),
        FaultKind.UNREADABLE,
        "length: wanted a whole number",
    ),
    "broken header": (change_attribute("outcome", "?"), FaultKind.UNREADABLE, "header is broken"),
    "odd camera": (change_attribute("cameras", {"../x": [5, 5]}), FaultKind.UNREADABLE, "plain"),
    "unknown code": (change_attribute("actors", ["policy"]), FaultKind.MISMATCH, "code 1"),
    "other name": (change_attribute("index", 5), FaultKind.MISMATCH, "holds the episode learning"),
    "changed header": (change_sealed("queries", 1), FaultKind.MISMATCH, "not as it was written"),
    "unknown field": (
        change_attribute("colour", 1),
        FaultKind.UNREADABLE,
        "unknown field 'colour'",
    ),
    "no digest": (without_digest("digest"), FaultKind.MISMATCH, "its digest is another"),
    "no digests": (without_digest("array_digests"), FaultKind.MISMATCH, "its digest is another"),
    "changed reward": (set_value("reward", 5.0), FaultKind.MISMATCH, "reward holds other values"),
    "link": (link, FaultKind.ODD_FILE, "reward/c.0 is a link|reward/c.0 is or lies behind"),
    "folder by a link": (link_folder, FaultKind.ODD_FILE, "is a link|reward.* lies behind"),
    "fifo": (fifo, FaultKind.ODD_FILE, "reward/c.0 is a fifo"),
    "grown": (grow, FaultKind.ODD_FILE, "reward/c.0 has .* bytes, wanted at most"),
    "newer schema": (
        change_attribute("schema", 3),
        FaultKind.SCHEMA,
        "1 or 2, found 3",
    ),
    "foreign group": (change_attribute("format", "x"), FaultKind.FOREIGN, "found another"),
    "truncated header": (truncate_header, FaultKind.UNREADABLE, "zarr.json does not decode"),
    "empty directory": (empty, FaultKind.FOREIGN, "found no zarr.json"),
}


NOT_IN_ARCHIVES = ("link", "folder by a link", "fifo", "grown")
"""An archive has none of these; the last one takes no room in a folder."""


@pytest.mark.parametrize(
    ("fault", "archived"),
    [
        *((fault, False) for fault in FAULTS),
        *((fault, True) for fault in FAULTS if fault not in NOT_IN_ARCHIVES),
    ],
)
def test_every_fault_is_found_and_stops_a_reader(
    store: EpisodeStore, episode: Episode, fault: str, archived: bool
) -> None:
    damage, kind, message = FAULTS[fault]
    name = store.append(episode)
    inside = unpacked(store, name)
    damage(inside)
    if archived:
        repacked(inside)
    found = [fault for fault in check(store) if fault.damaging]
    assert (name, kind) in {(fault.name, fault.kind) for fault in found}
    assert {fault.name for fault in found} == {name}
    assert len({fault.kind for fault in found}) == 1 or kind is FaultKind.ODD_FILE
    with pytest.raises(StoreError, match=f"{name}: .*{message}") as caught:
        store.read(name)
    assert "\n" not in str(caught.value)


def test_all_faults_of_an_episode_are_named(store: EpisodeStore, episode: Episode) -> None:
    name = store.append(episode)
    inside = unpacked(store, name)
    truncate_chunk(inside)
    delete_array(inside)
    repacked(inside)
    assert sorted(fault.kind for fault in check(store)) == ["missing", "unreadable"]


@pytest.mark.parametrize(
    ("path", "kinds"),
    [("executed", [FaultKind.NOT_FINITE]), ("score", []), ("threshold", []), ("proposed", [])],
)
def test_only_actions_that_count_must_be_finite(
    store: EpisodeStore, episode: Episode, path: str, kinds: list[FaultKind]
) -> None:
    name = store.append(episode)
    as_before(set_value(path, np.nan))(unpacked(store, name))
    assert [fault.kind for fault in check(store)] == kinds


def test_leftovers_and_foreign_entries(store: EpisodeStore, episode: Episode) -> None:
    name = store.append(episode)
    shutil.copy(archive_path(store.path, name), store.path / ".tmp-1234")
    (store.path / "notes.txt").touch()
    assert [(fault.name, fault.kind, fault.damaging) for fault in check(store)] == [
        (".tmp-1234", FaultKind.LEFTOVER, False),
        ("notes.txt", FaultKind.FOREIGN, True),
    ]
    assert store.names() == [name]


class TestTables:
    def printed(
        self, function: Callable[[str, Console], int], store: EpisodeStore
    ) -> tuple[int, str]:
        console = Console(file=StringIO(), width=200)
        code = function(str(store.path), console)
        assert isinstance(console.file, StringIO)
        return code, console.file.getvalue()

    def test_a_sound_store(self, store: EpisodeStore, episode: Episode) -> None:
        name = store.append(episode)
        (store.path / ".tmp-1234").mkdir()
        code, text = self.printed(print_list, store)
        assert code == 0
        assert name in text
        assert "1 episodes, 70 steps" in text
        code, text = self.printed(print_check, store)
        assert code == 0
        assert "1 episodes, 0 faults, 1 harmless leftovers" in text

    def test_many_episodes_are_plain_lines(
        self, store: EpisodeStore, episode: Episode, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        name = store.append(replace(episode, info=replace(episode.info, task="a\n\x1b[31m")))
        monkeypatch.setattr("sheath_manip.dataset.table.MOST_ROWS", 0)
        code, text = self.printed(print_list, store)
        assert code == 0
        address, headings, line, totals, *_ = text.splitlines()
        assert (address, headings.split()[:2]) == (str(store.path), ["episode", "task"])
        assert line.split()[:3] == [name, r"a\n\x1b[31m", "time-limit"]
        assert "1 episodes, 70 steps" in totals

    def test_what_has_no_digest_is_told(self, store: EpisodeStore, episode: Episode) -> None:
        unseal(unpacked(store, store.append(episode)))
        code, text = self.printed(print_check, store)
        assert code == 0
        assert "1 episodes, 0 faults" in text
        assert "1 episodes have no digest" in text

    def test_a_feature_that_is_no_number_is_told(
        self, store: EpisodeStore, episode: Episode
    ) -> None:
        seen = replace(episode.steps[3].observation, features=np.full(6, np.nan, np.float32))
        steps = list(episode.steps)
        steps[3] = replace(steps[3], observation=seen)
        name = store.append(replace(episode, steps=tuple(steps)))
        code, text = self.printed(print_check, store)
        assert code == 0
        assert f"{name} " in text
        assert "feature 0 is nan in step 3, and 5 more values" in " ".join(text.split())
        assert "0 faults, 0 harmless leftovers, 1 remarks" in text

    def test_a_damaged_store(self, store: EpisodeStore, episode: Episode) -> None:
        name = store.append(episode)
        truncate_header(unpacked(store, name))
        code, text = self.printed(print_list, store)
        assert code == 1
        assert f"{name}: its zarr.json does not decode" in text
        code, text = self.printed(print_check, store)
        assert code == 1
        assert "unreadable" in text

    def test_no_store(self, tmp_path: Path) -> None:
        for function in (print_list, print_check):
            with pytest.raises(StoreError, match="wanted an episode store"):
                function(str(tmp_path / "missing"), Console(file=StringIO()))
