from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.dataset.exchange.selection import (
    ActionChoice,
    Selection,
    piece,
    runs,
    selected,
)
from sheath_manip.dataset.rows import episode_from
from sheath_manip.dataset.steps import by_expert
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Breakdown, Outcome
from tests.episodes import INFO, episode_of
from tools.identical import identical


def methods(store: EpisodeStore, selection: Selection) -> list[tuple[str, int]]:
    found = selected(store, selection)
    return [(recorded.header.info.method, recorded.header.length) for recorded in found]


def test_runs() -> None:
    assert runs(np.array([True, True, False, True])) == [(0, 2), (3, 4)]
    assert runs(np.zeros(3, bool)) == []


def test_each_run_of_the_expert_is_an_episode(store: EpisodeStore) -> None:
    name = store.append(episode_of("peepppe"))
    assert methods(store, Selection()) == [("", 7)]
    assert methods(store, Selection(expert_steps=True)) == [("-from0001", 2), ("-from0006", 1)]
    first, last = selected(store, Selection(expert_steps=True))
    whole, cut = store.read(name), episode_from(first.header, first.arrays)
    assert [s.observation.time_s for s in cut.steps] == [0.1, 0.2]
    assert cut.final_observation.time_s == whole.steps[3].observation.time_s
    assert (cut.terminated, cut.truncated) == (False, True)
    assert (first.header.expert_steps, first.header.queries) == (2, 2)
    assert by_expert(first.header, first.arrays).all()
    end = episode_from(last.header, last.arrays)
    assert end.final_observation.time_s == whole.final_observation.time_s
    assert (end.terminated, end.truncated) == (True, False)


def test_a_piece_tells_of_waits_and_breakdowns_in_its_own_steps(store: EpisodeStore) -> None:
    broken = Breakdown("gate", "ValueError")
    episode = episode_of("ppeeeep")
    steps = tuple(
        replace(
            step,
            decision=replace(
                step.decision,
                waited_s={2: 1.5, 6: 0.5}.get(place, 0.0),
                broken=(broken,) if place in (3, 4) else (),
            ),
        )
        for place, step in enumerate(episode.steps)
    )
    whole = replace(episode, steps=steps, outcome=Outcome.ERROR, cut_short_by=broken)
    recorded = store.recorded(store.append(whole))
    for start, stop, waits, breakdowns in ((2, 6, {0: 1.5}, {1, 2}), (4, 7, {2: 0.5}, {0})):
        cut = piece(recorded, start, stop)
        read = episode_from(cut.header, cut.arrays)
        told = [step.decision for step in read.steps]
        assert {t: each.waited_s for t, each in enumerate(told) if each.waited_s} == waits
        assert {t for t, each in enumerate(told) if each.broken} == breakdowns
        assert read.columns.waited_s.sum() == sum(waits.values())
        # Only where the whole was cut short is the piece.
        assert read.cut_short_by == (broken if stop == 7 else None)


def test_a_whole_episode_stays_as_it_is(store: EpisodeStore) -> None:
    name = store.append(episode_of("pe"))
    recorded = store.recorded(name)
    assert piece(recorded, 0, 2) is recorded
    assert identical(episode_from(recorded.header, recorded.arrays), store.read(name))


def test_labelled_actions_leave_out_states_without(store: EpisodeStore) -> None:
    store.append(episode_of("pppp", "xx.x"))
    assert methods(store, Selection(action=ActionChoice.LABELLED)) == [
        ("-from0000", 2),
        ("-from0003", 1),
    ]


def test_successes_and_rounds(store: EpisodeStore) -> None:
    for round, outcome in ((0, Outcome.SUCCESS), (1, Outcome.FAILURE), (2, Outcome.SUCCESS)):
        store.append(episode_of("p", info=replace(INFO, round=round), outcome=outcome))

    def rounds(selection: Selection) -> list[int]:
        return [recorded.header.info.round for recorded in selected(store, selection)]

    assert rounds(Selection()) == [0, 1, 2]
    assert rounds(Selection(successes=True)) == [0, 2]
    assert rounds(Selection(rounds=(1, 2))) == [1, 2]
    with pytest.raises(StoreError, match=r"of the 3 episodes in .* nothing is selected"):
        rounds(Selection(successes=True, rounds=(1,)))
