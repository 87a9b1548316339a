"""The moments of episodes: found, noted beside the store, and never trusted over the episodes."""

import math
from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.dataset.check import check
from sheath_manip.dataset.glimpse import glimpses
from sheath_manip.dataset.moment_notes import NOTES, all_moments
from sheath_manip.dataset.moments import (
    MOST_NEAR_MISSES,
    EpisodeMoments,
    margins_of,
    moments_from_json,
    moments_to_json,
)
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Actor, Episode, EpisodeInfo, Purpose, Reason
from tests.episodes import episode_of

INFO = EpisodeInfo("toy", 7, Purpose.LEARNING, 10.0)


def scored(actors: str, scores: list[float], **rest) -> Episode:
    """An episode whose gate gave such scores, with a threshold of 0."""
    episode = episode_of(actors, **rest)
    steps = [
        replace(step, decision=replace(step.decision, score=score))
        for step, score in zip(episode.steps, scores, strict=True)
    ]
    return replace(episode, steps=tuple(steps))


def found(episode: Episode, store: EpisodeStore) -> EpisodeMoments:
    return store.moments(store.append(episode))


@pytest.fixture
def read(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The names of the episodes whose arrays were read for their moments."""
    names: list[str] = []
    whole = EpisodeReader.moments

    def counted(self: EpisodeReader, name: str) -> EpisodeMoments:
        names.append(name)
        return whole(self, name)

    monkeypatch.setattr(EpisodeReader, "moments", counted)
    return names


def test_a_margin_is_in_units_of_what_is_usual() -> None:
    score, threshold = np.array([3.0, 1.0, -1.0, np.nan, 1.0]), np.array([1.0, 1, 1, 1, 3.4e38])
    assert margins_of(score, threshold)[:3].tolist() == [1.0, 0.0, -1.0]
    assert np.isnan(margins_of(score, threshold)[3:]).all()
    assert np.isnan(margins_of(np.zeros(3), np.zeros(3))).all()


def test_takeovers_say_why_and_how_low_the_score_was(store: EpisodeStore) -> None:
    moments = found(scored("ppeepp", [1.0, 1.0, -0.5, -2.0, 1.0, 1.0]), store)
    (takeover,) = moments.takeovers
    assert (takeover.start, takeover.stop, takeover.margin) == (2, 4, -2.0)
    assert (takeover.reason, takeover.actor) == (Reason.OUTSIDE, Actor.EXPERT)
    assert moments.near_misses == ()


def test_a_near_miss_is_no_way_into_a_takeover_and_not_told_ten_times(store: EpisodeStore) -> None:
    scores = [1.0, 0.05, -1.0, 0.05, 1.0, 0.01, 0.05, 1.0, *([0.09, 1.0, 1.0] * 5)]
    moments = found(scored("ppe" + "p" * 20, scores), store)
    assert len(moments.near_misses) == MOST_NEAR_MISSES
    assert moments.near_misses[0].step == 5
    assert math.isclose(moments.near_misses[0].margin, 0.01)
    # A demonstration has neither.
    alone = episode_of("eee", policy=False, info=replace(INFO, purpose=Purpose.DEMONSTRATION))
    assert found(alone, store) == EpisodeMoments()


def test_moments_come_back_from_json(store: EpisodeStore) -> None:
    moments = found(scored("ppeepp", [1.0, 0.01, 0.5, np.nan, 1.0, 1.0]), store)
    assert moments_from_json(moments_to_json(moments)) == moments


def test_what_is_noted_is_not_read_again_unless_it_is_another_file(
    store: EpisodeStore, read: list[str]
) -> None:
    names = [store.append(episode_of("ppep", info=replace(INFO, index=i))) for i in range(5)]
    first = dict(all_moments(store))
    assert sorted(read) == names
    assert (store.path / NOTES).exists()
    assert check(store) == []
    read.clear()
    assert dict(all_moments(EpisodeStore(store.path))) == first
    assert read == []
    store.drop(names[0])
    store.append(episode_of("pppp", info=INFO))
    told = dict(all_moments(store))
    assert read == names[:1]
    assert told[names[0]] == EpisodeMoments()


@pytest.mark.parametrize("spoilt", [b"", b"rubbish\n" * 3, b'00000000 [1, "x"]\n', b"\0" * 99])
def test_broken_notes_cost_time_only(store: EpisodeStore, spoilt: bytes, read: list[str]) -> None:
    store.append(episode_of("ppep"))
    first = dict(all_moments(store))
    (store.path / NOTES).write_bytes(spoilt)
    assert dict(all_moments(store)) == first
    assert len(read) == 2


def test_a_damaged_episode_is_told_of_and_the_others_are_found(store: EpisodeStore) -> None:
    names = [store.append(episode_of("ppep", info=replace(INFO, index=i))) for i in range(2)]
    path = store.path / f"{names[0]}.zarr.zip"
    path.write_bytes(path.read_bytes()[:-40])
    told = dict(all_moments(store))
    assert "sheath data" in str(told[names[0]])
    assert isinstance(told[names[1]], EpisodeMoments)


def test_images_of_some_steps(store: EpisodeStore) -> None:
    episode = episode_of("p" * 130, side_px=16)
    name = store.append(episode)
    for step, seen in zip((0, 63, 64, 129), glimpses(store, name, (0, 63, 64, 129)), strict=True):
        assert np.array_equal(seen["top"], episode.steps[step].observation.images["top"])
    other = store.append(episode_of("pp", info=replace(INFO, index=1)))
    assert glimpses(store, other, (0,)) == [{}]
