"""Waits for a person are kept in an episode's header, and only where there are any."""

from dataclasses import asdict, replace

import pytest

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.header import header_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.waits import Wait, waits_from_json, waits_of
from sheath_manip.types import Episode
from tests.episodes import episode_of


def with_waits(waits: dict[int, float]) -> Episode:
    episode = episode_of("p" * 5)
    steps = tuple(
        replace(step, decision=replace(step.decision, waited_s=waits.get(place, 0.0)))
        for place, step in enumerate(episode.steps)
    )
    return replace(episode, steps=steps)


def test_they_come_back_with_their_steps(tmp_path):
    store, episode = EpisodeStore.create(tmp_path / "store"), with_waits({0: 0.5, 3: 1.25})
    assert waits_of(episode) == (Wait(0, 0.5), Wait(3, 1.25))
    name = store.append(episode)
    read = store.read(name)
    assert [step.decision.waited_s for step in read.steps] == [0.5, 0.0, 0.0, 1.25, 0.0]
    assert read.columns.waited_s.sum() == 1.75


def test_an_episode_without_any_is_written_as_before():
    assert "waits" not in to_attributes(header_of(with_waits({})))
    assert "waits" in to_attributes(header_of(with_waits({1: 2.0})))


@pytest.mark.parametrize(
    "content", [{}, [{"step": 1}], [{"step": -1, "waited_s": 1.0}], [{"step": 1, "waited_s": 0.0}],
                [{"step": 1, "waited_s": "Infinity"}], [{"step": 1, "waited_s": 1.0, "why": ""}]]
)  # fmt: skip
def test_what_is_no_wait_is_refused(content):
    with pytest.raises(ValueError, match=r"wanted|no field|unknown field"):
        waits_from_json(content)
    assert waits_from_json([asdict(Wait(1, 2.0))]) == (Wait(1, 2.0),)
