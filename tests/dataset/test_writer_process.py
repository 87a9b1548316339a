"""The process that writes: it does as it is told, finishes what it was given, and is missed."""

import io
import os
import pickle
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.dataset.background import BackgroundRecorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.writer_process import WriterProcess, serve
from sheath_manip.exceptions import StoreError
from tests.episodes import INFO, episode_of

FILES = {"zarr.json": b"{}", "a/zarr.json": b"{}", "a/b/c.0": bytes(100_000), "a/b/empty": b""}
EPISODES = [episode_of("pe", info=replace(INFO, index=index)) for index in range(2)]


@pytest.fixture
def writer() -> Iterator[WriterProcess]:
    writer = WriterProcess()
    yield writer
    writer.close()


def held(folder: Path) -> dict[str, bytes]:
    files = (file for file in folder.rglob("*") if file.is_file())
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in files}


def test_files_get_their_name_together(writer: WriterProcess, tmp_path: Path) -> None:
    for number in range(2):
        writer.publish(FILES, tmp_path / "aside", tmp_path / f"final{number}")
        assert held(tmp_path / f"final{number}") == FILES
        assert not (tmp_path / "aside").exists()


def test_a_path_is_where_it_is_for_who_asks(
    writer: WriterProcess, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    writer.publish(FILES, Path("aside"), Path("final"))
    assert held(tmp_path / "final") == FILES


def test_what_goes_wrong_there_is_raised_here(writer: WriterProcess, tmp_path: Path) -> None:
    (tmp_path / "taken" / "file").mkdir(parents=True)
    with pytest.raises(FileExistsError, match="taken exists"):
        writer.publish(FILES, tmp_path / "aside", tmp_path / "taken")
    with pytest.raises(FileNotFoundError, match="missing"):
        writer.publish(FILES, tmp_path / "missing" / "aside", tmp_path / "final")
    writer.publish(FILES, tmp_path / "other", tmp_path / "final")


@pytest.mark.parametrize("before", [0, 1])
def test_a_writer_that_is_gone_is_one_line(store: EpisodeStore, before: int) -> None:
    def record() -> None:
        with BackgroundRecorder(store) as recorder:
            for index, episode in enumerate(EPISODES):
                if index == before:
                    recorder._wait()
                    os.kill(recorder._writer.process_id, signal.SIGKILL)
                recorder.on_end(episode)

    with pytest.raises(StoreError, match=r"cannot write .* ended with code -9; run it again"):
        record()
    assert len(store.names()) == before
    assert not list(store.path.glob(".tmp-*"))


def test_a_process_that_cannot_be_started_is_one_line(
    store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.executable", "/nowhere/python")
    with pytest.raises(StoreError, match="cannot start the process that writes"):
        BackgroundRecorder(store)


def test_ctrl_c_is_not_for_the_writer(writer: WriterProcess) -> None:
    assert os.getpgid(writer.process_id) != os.getpgid(0)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
def test_half_a_request_is_none(tmp_path: Path, share: float) -> None:
    whole, half = (
        pickle.dumps((FILES, tmp_path / f"aside{n}", tmp_path / f"final{n}")) for n in range(2)
    )
    answers = io.BytesIO()
    serve(io.BytesIO(whole + half[: int(share * len(half))]), answers)
    assert [path.name for path in tmp_path.iterdir()] == ["final0"]
    assert answers.getvalue() == pickle.dumps(None, pickle.HIGHEST_PROTOCOL)
