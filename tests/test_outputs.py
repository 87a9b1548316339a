"""What is written appears whole or not at all, and nothing half-made blocks the next try."""

import resource
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.files.json_files import write_json
from sheath_manip.files.outputs import PREFIX, written_aside
from tools.synthetic import synthetic_episode, synthetic_info


def names(folder: Path) -> list[str]:
    return sorted(entry.name for entry in folder.iterdir())


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """As on a full disk: what would grow over that cannot be written."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_what_fails_leaves_what_was_there(tmp_path: Path) -> None:
    final = tmp_path / "deep" / "x.json"
    write_json(final, [1])
    with files_of_at_most(1000), pytest.raises(OSError, match="too large"):
        write_json(final, ["x" * 5000])
    assert final.read_text() == "[\n 1\n]"
    assert names(final.parent) == ["x.json"]


def test_a_name_that_is_taken_is_kept(tmp_path: Path) -> None:
    (tmp_path / "x").write_text("mine")
    with pytest.raises(FileExistsError), written_aside(tmp_path / "x", replacing=False) as aside:
        aside.write_text("other")
    (tmp_path / "folder" / "y").mkdir(parents=True)
    with pytest.raises(FileExistsError), written_aside(tmp_path / "folder", False) as aside:
        aside.mkdir()
    assert (tmp_path / "x").read_text() == "mine"
    assert names(tmp_path) == ["folder", "x"]


def test_a_disk_without_links_serves_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise PermissionError("no links here")

    monkeypatch.setattr(Path, "hardlink_to", refuse)
    with written_aside(tmp_path / "x", replacing=False) as aside:
        aside.write_text("whole")
    with pytest.raises(FileExistsError), written_aside(tmp_path / "x", replacing=False) as aside:
        aside.write_text("other")
    assert (tmp_path / "x").read_text() == "whole"
    assert names(tmp_path) == ["x"]


KILLED = """
import os, sys
from pathlib import Path
from sheath_manip.files.outputs import written_aside
with written_aside(Path(sys.argv[1])) as aside:
    aside.write_text("half")
    os.kill(os.getpid(), 9)
"""


def test_what_a_killed_process_left_is_swept_away(tmp_path: Path) -> None:
    subprocess.run([sys.executable, "-c", KILLED, str(tmp_path / "x")], check=False)
    (left,) = names(tmp_path)
    assert left.startswith(PREFIX)
    with written_aside(tmp_path / "x") as aside:
        # What is still being written stays.
        write_json(tmp_path / "y", 1)
        aside.write_text("whole")
    assert names(tmp_path) == ["x", "y"]


@pytest.fixture
def store(tmp_path: Path) -> EpisodeStore:
    store = EpisodeStore.create(tmp_path / "store")
    store.append(synthetic_episode(synthetic_info(3, 0), length=40, pixels=32))
    return store


@pytest.mark.parametrize(
    ("form", "target"), [("robomimic", "x.hdf5"), ("replay-buffer", "x.zarr.zip")]
)
def test_an_export_onto_a_full_disk_can_be_tried_again(store, tmp_path, form, target) -> None:
    out = tmp_path / "out"
    with files_of_at_most(60_000), pytest.raises(StoreError, match=r"cannot write .* nothing is"):
        export(store, out / target, form, Selection())
    assert names(out) == []
    assert export(store, out / target, form, Selection()).episodes == 1


def test_room_is_asked_for_before_an_episode_is_written(store, tmp_path, monkeypatch) -> None:
    usage = type("usage", (), {"free": 100_000_000})
    monkeypatch.setattr("sheath_manip.dataset.disk.shutil.disk_usage", lambda _: usage)
    with pytest.raises(StoreError, match=r"has 100 MB free, wanted 200 MB"):
        export(store, tmp_path / "out" / "x.hdf5", "robomimic", Selection())
    assert names(tmp_path / "out") == []
