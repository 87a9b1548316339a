"""A folder that appears all at once is on the disk before its name is."""

import ctypes
import errno
from pathlib import Path

import pytest

from sheath_manip.dataset import durable
from sheath_manip.dataset.durable import publish


@pytest.fixture
def aside(tmp_path: Path) -> Path:
    inside = tmp_path / "aside" / "x"
    inside.mkdir(parents=True)
    (inside / "file").write_text("here")
    return tmp_path / "aside"


def test_each_file_and_folder_is_synced_where_there_is_no_call_for_all(
    aside: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(durable, "_syncfs", None)
    synced: list[Path] = []
    monkeypatch.setattr(durable, "sync", synced.append)
    publish(aside, aside.with_name("final"))
    assert synced == [aside / "x/file", aside / "x", aside, aside.parent]


def test_or_the_file_system_is(aside: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(_: int) -> int:
        ctypes.set_errno(errno.EIO)
        return -1

    final = aside.with_name("final")
    monkeypatch.setattr(durable, "_syncfs", broken)
    with pytest.raises(OSError, match="Input/output error"):
        publish(aside, final)
    assert not final.exists()
    monkeypatch.setattr(durable, "_syncfs", lambda _: 0)
    publish(aside, final)
    assert (final / "x" / "file").read_text() == "here"
