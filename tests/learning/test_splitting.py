"""Which of a store's episodes are held out for the threshold."""

from dataclasses import replace

import pytest

from sheath_manip.dataset.reader import EpisodeSummary
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.learning.splitting import learned_and_left, split_off
from sheath_manip.types import Purpose
from tests.episodes import INFO, episode_of


def recorded(tmp_path, scenes: list[tuple[int, str]], **changes) -> list[EpisodeSummary]:
    store = EpisodeStore.create(tmp_path / "store")
    for index, session in scenes:
        info = replace(INFO, purpose=Purpose.DEMONSTRATION, seed=100 + index, index=index)
        store.append(episode_of("e" * 3, info=replace(info, session=session, **changes)))
    return store.infos()


def split(summaries: list[EpisodeSummary], held_out: int) -> tuple[set[str], set[str]]:
    scenes = {each.name: f"{each.info.index}{each.info.session}" for each in summaries}
    fitted, held = split_off(summaries, (), held_out, "here", "record more")
    return {scenes[name] for name in fitted}, {scenes[name] for name in held}


def test_the_last_of_the_expert_are_held_out(tmp_path):
    assert split(recorded(tmp_path, [(each, "") for each in range(5)]), 2) == (
        {"0", "1", "2"},
        {"3", "4"},
    )


def test_of_a_scene_that_was_recorded_twice_all_is_held_out(tmp_path):
    twice = recorded(tmp_path, [(each, session) for each in range(4) for session in ("a", "b")])
    assert split(twice, 3) == ({"0a", "0b", "1a", "1b"}, {"2a", "2b", "3a", "3b"})


@pytest.mark.parametrize("held_out", [5, 7, 30])
def test_there_must_be_more_than_are_held_out(tmp_path, held_out):
    with pytest.raises(ParameterError, match=f"holds 5 .* wanted more than the {held_out} "):
        split(recorded(tmp_path, [(each, "") for each in range(5)]), held_out)


def test_what_policies_are_judged_on_is_neither_learned_from_nor_told_of(tmp_path):
    judged = recorded(tmp_path, [(0, ""), (1, "")])
    assert learned_and_left(judged, False) == (judged, [])
    judged = [replace(each, info=replace(each.info, purpose=Purpose.EVALUATION)) for each in judged]
    assert learned_and_left(judged, True) == ([], [])
