"""The process that writes: it does as it is told, finishes what it was given, and is missed."""

import io
import os
import pickle
import signal
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset import writer_process
from sheath_manip.dataset.background import BackgroundRecorder
from sheath_manip.dataset.check import check
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.steps import recorded_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.writer_process import WriterProcess, messages, serve
from sheath_manip.exceptions import StoreError
from tests.episodes import INFO, episode_of
from tools.identical import identical
from tools.synthetic import synthetic_episode

FILMED = [episode_of("pe", info=replace(INFO, index=index), side_px=4) for index in range(2)]
EPISODES = [episode_of("pe", info=replace(INFO, index=index)) for index in range(2)]


@pytest.fixture
def writer(store: EpisodeStore) -> Iterator[WriterProcess]:
    writer = WriterProcess(store.path)
    yield writer
    writer.close()


def test_what_it_adopts_is_in_the_store(writer: WriterProcess, store: EpisodeStore) -> None:
    for episode in EPISODES:
        writer.append_arrays(recorded_of(episode))
        assert identical(store.read(episode_name(episode.info)), episode)
    assert check(store) == []


def test_a_path_is_where_it_was_at_the_start(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    store = EpisodeStore.create("store")
    with BackgroundRecorder(store) as recorder:
        (tmp_path / "elsewhere").mkdir()
        monkeypatch.chdir(tmp_path / "elsewhere")
        recorder.on_end(EPISODES[0])
    assert len(EpisodeStore(tmp_path / "store").names()) == 1


def test_what_goes_wrong_there_is_told_here(writer: WriterProcess, store: EpisodeStore) -> None:
    store.append(EPISODES[0])
    other = episode_of("pp", info=EPISODES[0].info, side_px=4)
    with pytest.raises(StoreError, match="already holds"):
        writer.append_arrays(recorded_of(other))
    # The very same is there already, as two processes of one run may have it.
    writer.append_arrays(recorded_of(EPISODES[0]))
    good = recorded_of(EPISODES[1])
    arrays = {path: array for path, array in good.arrays.items() if path != "executed"}
    with pytest.raises(StoreError, match="executed is missing"):
        writer.append_arrays(replace(good, arrays=arrays))
    writer.append_arrays(good)
    assert len(store.names()) == 2


@pytest.mark.parametrize("before", [0, 1])
def test_a_writer_that_is_gone_is_one_line(store: EpisodeStore, before: int) -> None:
    def record() -> None:
        with BackgroundRecorder(store) as recorder:
            for index, episode in enumerate(EPISODES):
                if index == before:
                    recorder.flush()
                    os.kill(recorder._writer.process_id, signal.SIGKILL)
                recorder.on_end(episode)

    with pytest.raises(StoreError, match=r"writes into .* ended with code -9; .* stored all"):
        record()
    assert len(store.names()) == before + 1
    assert check(store) == []


def test_a_writer_that_was_stopped_holds_nobody_up(
    store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(writer_process, "PATIENCE_S", 0.2)
    # Larger than what a pipe takes before it is read.
    episode = synthetic_episode(EPISODES[0].info, length=70, pixels=32)
    with BackgroundRecorder(store) as recorder:
        os.kill(recorder._writer.process_id, signal.SIGSTOP)
        recorder.on_end(episode)
        with pytest.raises(
            StoreError, match=r"did nothing for 0\.2 s and was ended; .* stored all"
        ):
            recorder.flush()
    assert identical(store.read(episode_name(episode.info)), episode)


def test_a_writer_takes_no_more_memory_for_a_longer_episode(writer: WriterProcess) -> None:
    def peak_mb() -> float:
        status = Path(f"/proc/{writer.process_id}/status").read_text()
        return int(status.partition("VmHWM:")[2].split()[0]) / 1e3

    image = np.zeros((256, 256, 3), np.uint8)
    peaks = []
    for index, length in enumerate((64, 640)):
        short = synthetic_episode(replace(INFO, index=index), length, pixels=1)
        seen = replace(short.final_observation, images={"front": image})
        steps = tuple(replace(step, observation=seen) for step in short.steps)
        writer.append_arrays(recorded_of(replace(short, steps=steps, final_observation=seen)))
        peaks.append(peak_mb())
    # The longer one has 113 MB more of images.
    assert peaks[1] < peaks[0] + 16


def test_a_process_that_cannot_be_started_is_one_line(
    store: EpisodeStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.executable", "/nowhere/python")
    with pytest.raises(StoreError, match="cannot start the process that writes"):
        BackgroundRecorder(store)


def test_ctrl_c_is_not_for_the_writer(writer: WriterProcess) -> None:
    assert os.getpgid(writer.process_id) != os.getpgid(0)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.99])
def test_half_a_request_is_none(store: EpisodeStore, share: float) -> None:
    episodes = FILMED
    whole, half = (b"".join(messages(recorded_of(episode))) for episode in episodes)
    answers = io.BytesIO()
    serve(str(store.path), io.BytesIO(whole + half[: int(share * len(half))]), answers)
    assert store.names() == [episode_name(episodes[0].info)]
    assert check(store) == []
    assert answers.getvalue() == pickle.dumps(None, pickle.HIGHEST_PROTOCOL)
