"""An import in a process of its own: whatever becomes of that, this one tells in a line."""

from pathlib import Path

import numpy as np
import pytest
import zarr

from sheath_manip.dataset.exchange import apart, limits
from sheath_manip.dataset.exchange.apart import import_apart
from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import Imported, Origin
from sheath_manip.dataset.exchange.key_map import KeyMap
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.types import EpisodeInfo, Outcome, Purpose

INFO = EpisodeInfo("push", 0, Purpose.DEMONSTRATION, 10.0, method="other", variant="")
ORIGIN = Origin(INFO, Outcome.SUCCESS, KeyMap.parse(["features=pos"]))
STAGES = "import os; os.mkdir('{store}/.tmp-import-%d-1' % os.getpid()); "


@pytest.fixture
def buffer(tmp_path: Path) -> Path:
    root = zarr.create_group(tmp_path / "b.zarr", zarr_format=2)
    root.create_array("data/pos", data=np.zeros((4, 2)))
    root.create_array("data/action", data=np.ones((4, 1), np.float32))
    root.create_array("meta/episode_ends", data=np.array([2, 4]))
    return tmp_path / "b.zarr"


def test_it_does_as_in_this_process(buffer, store: EpisodeStore) -> None:
    done = import_apart("replay-buffer", buffer, store.path, ORIGIN)
    assert done == Imported(added=2, held=0, sealed=False)
    assert len(store.names()) == 2
    with pytest.raises(ParameterError, match="give --task and --control-rate-hz"):
        import_apart("replay-buffer", buffer, store.path, None)
    with pytest.raises(StoreError, match="wanted an HDF5 file"):
        import_apart("robomimic", buffer, store.path, ORIGIN)


def test_a_url_is_no_directory(buffer, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StoreError, match="is a URL, wanted a directory"):
        import_apart("replay-buffer", buffer, Path("s3://bucket/demos"), ORIGIN)
    assert [entry.name for entry in tmp_path.iterdir()] == ["b.zarr"]


@pytest.mark.parametrize(
    ("code", "message"),
    [
        ("os.abort()", "ended its process with code -6"),
        ("import time; time.sleep(600)", "takes longer than"),
    ],
)
def test_what_ends_or_holds_up_the_process_is_told(
    buffer, store: EpisodeStore, monkeypatch, code, message
) -> None:
    monkeypatch.setattr(apart, "_CODE", STAGES.format(store=store.path) + code)
    monkeypatch.setattr(apart, "GRACE_S", 3.0 - 300.0)
    with pytest.raises(StoreError, match=message) as caught:
        import_apart("replay-buffer", buffer, store.path, ORIGIN)
    assert "nothing is imported" in str(caught.value)
    assert [entry.name for entry in store.path.iterdir()] == ["sheath-store.json"]


def test_more_memory_than_a_file_may_take_is_told(buffer, store, monkeypatch) -> None:
    no_more = "from sheath_manip.dataset.exchange import apart; apart.MEMORY_BYTES = -1 << 28; "
    serves = "apart.MEMORY_TIMES = 1; apart.serve(sys.stdin.buffer, sys.stdout.buffer)"
    paths = "import sys; sys.path[:] = sys.argv[1:]; "
    monkeypatch.setattr(apart, "_CODE", paths + no_more + serves)
    # 64 MB an episode, and next to nothing on the disk.
    root = zarr.open_group(buffer, mode="r+")
    root.create_array("data/pos", data=np.zeros((4, 4_000_000)), overwrite=True)
    with pytest.raises(StoreError, match="nothing is imported"):
        import_apart("replay-buffer", buffer, store.path, ORIGIN)
    assert [entry.name for entry in store.path.iterdir()] == ["sheath-store.json"]


def test_reading_ends_when_its_time_is_up(buffer, monkeypatch) -> None:
    monkeypatch.setattr(limits, "LEAST_S", -1.0)
    with pytest.raises(StoreError, match=r"reading .*b\.zarr takes longer than"):
        open_file("replay-buffer", buffer)
