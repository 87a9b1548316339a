import json
import shutil
from collections.abc import Callable
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import zarr
from rich.console import Console

from sheath_manip.dataset.check import check
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.table import print_check, print_list
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Episode


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
        group = json.loads((episode / "zarr.json").read_text())
        group["attributes"][key] = value
        (episode / "zarr.json").write_text(json.dumps(group))

    return change


def set_value(path: str, value: float) -> Callable[[Path], None]:
    def change(episode: Path) -> None:
        array = zarr.open_group(episode, mode="r+")[path]
        assert isinstance(array, zarr.Array)
        array[0] = value

    return change


def truncate_header(episode: Path) -> None:
    (episode / "zarr.json").write_bytes((episode / "zarr.json").read_bytes()[:50])


def empty(episode: Path) -> None:
    shutil.rmtree(episode)
    episode.mkdir()


FAULTS = {
    "truncated chunk": (truncate_chunk, FaultKind.UNREADABLE, "images/front does not decode"),
    "changed bit": (flip_bit, FaultKind.UNREADABLE, "images/front does not decode"),
    "missing chunk": (delete_chunk, FaultKind.MISSING, "executed has 0 of 1 chunks"),
    "missing array": (delete_array, FaultKind.MISSING, "the array score is missing"),
    "broken array": (break_array_metadata, FaultKind.UNREADABLE, "score does not decode"),
    "length": (change_attribute("length", 69), FaultKind.MISMATCH, r"front is uint8 \(70, .* \(69"),
    "no length": (change_attribute("length", 0), FaultKind.UNREADABLE, "at least one step"),
    "broken header": (change_attribute("outcome", "?"), FaultKind.UNREADABLE, "header is broken"),
    "odd camera": (change_attribute("cameras", {"../x": [5, 5]}), FaultKind.UNREADABLE, "plain"),
    "unknown code": (change_attribute("actors", ["policy"]), FaultKind.MISMATCH, "code 1"),
    "other name": (change_attribute("index", 5), FaultKind.MISMATCH, "holds the episode learning"),
    "newer schema": (
        change_attribute("schema", 3),
        FaultKind.SCHEMA,
        "1 or 2, found 3",
    ),
    "foreign group": (change_attribute("format", "x"), FaultKind.FOREIGN, "found another"),
    "truncated header": (truncate_header, FaultKind.UNREADABLE, "zarr.json does not decode"),
    "empty directory": (empty, FaultKind.FOREIGN, "found no zarr.json"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_every_fault_is_found_and_stops_a_reader(
    store: EpisodeStore, episode: Episode, fault: str
) -> None:
    damage, kind, message = FAULTS[fault]
    name = store.append(episode)
    damage(store.path / name)
    found = check(store)
    assert {(entry.name, entry.kind) for entry in found} == {(name, kind)}
    with pytest.raises(StoreError, match=f"{name}: .*{message}") as caught:
        store.read(name)
    assert "\n" not in str(caught.value)


def test_all_faults_of_an_episode_are_named(store: EpisodeStore, episode: Episode) -> None:
    name = store.append(episode)
    truncate_chunk(store.path / name)
    delete_array(store.path / name)
    assert sorted(fault.kind for fault in check(store)) == ["missing", "unreadable"]


@pytest.mark.parametrize(
    ("path", "kinds"),
    [("executed", [FaultKind.NOT_FINITE]), ("score", []), ("threshold", []), ("proposed", [])],
)
def test_only_actions_that_count_must_be_finite(
    store: EpisodeStore, episode: Episode, path: str, kinds: list[FaultKind]
) -> None:
    name = store.append(episode)
    set_value(path, np.nan)(store.path / name)
    assert [fault.kind for fault in check(store)] == kinds


def test_leftovers_and_foreign_entries(store: EpisodeStore, episode: Episode) -> None:
    name = store.append(episode)
    shutil.copytree(store.path / name, store.path / ".tmp-1234")
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

    def test_a_damaged_store(self, store: EpisodeStore, episode: Episode) -> None:
        name = store.append(episode)
        truncate_header(store.path / name)
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
