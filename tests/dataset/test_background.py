"""Recording beside the next episode: nothing is lost, and nothing goes wrong unheard."""

import threading
from dataclasses import replace

import pytest

from sheath_manip.dataset.background import BackgroundRecorder
from sheath_manip.dataset.check import check
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.protocols import Listener
from sheath_manip.types import Episode
from tests.episodes import INFO, episode_of
from tests.waiting import DEADLINE_S
from tools.identical import identical

EPISODES = [episode_of("pe", info=replace(INFO, index=index)) for index in range(3)]


def test_at_the_end_all_is_on_the_disk(store: EpisodeStore) -> None:
    with BackgroundRecorder(store) as recorder:
        listener: Listener = recorder
        for episode in EPISODES:
            listener.on_end(episode)
    assert [identical(store.read(n), e) for n, e in zip(store.names(), EPISODES, strict=True)]
    assert check(store) == []


def test_the_next_episode_runs_meanwhile(store: EpisodeStore, monkeypatch) -> None:
    go = threading.Event()
    with BackgroundRecorder(store) as recorder:
        append = recorder._writer.append_arrays

        def slow(recorded: Recorded) -> None:
            assert go.wait(DEADLINE_S)
            append(recorded)

        monkeypatch.setattr(recorder._writer, "append_arrays", slow)
        recorder.on_end(EPISODES[0])
        assert store.names() == []
        go.set()
        recorder.on_end(EPISODES[1])
        assert len(store.names()) >= 1
    assert len(store.names()) == 2


def end(recorder: BackgroundRecorder, episodes: list[Episode]) -> None:
    for episode in episodes:
        recorder.on_end(episode)


@pytest.mark.parametrize("after", [[], EPISODES[1:]])
def test_what_cannot_be_written_is_told(store: EpisodeStore, after: list[Episode]) -> None:
    store.append(episode_of("pp", info=EPISODES[0].info))
    with pytest.raises(StoreError, match="already holds"), BackgroundRecorder(store) as recorder:
        end(recorder, [EPISODES[0], *after])
    assert len(store.names()) == 1


@pytest.mark.parametrize("trouble", [KeyboardInterrupt(), ValueError()])
def test_an_interruption_loses_nothing(store: EpisodeStore, trouble: BaseException) -> None:
    def interrupted() -> None:
        with BackgroundRecorder(store) as recorder:
            recorder.on_end(EPISODES[0])
            raise trouble

    with pytest.raises(type(trouble)):
        interrupted()
    assert len(store.names()) == 1
