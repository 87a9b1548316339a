"""Stores of before an episode was one file: read as ever, and recorded into."""

import json
import shutil
from pathlib import Path

import pytest

from sheath_manip.dataset.check import check
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.merging import Merged, merge
from sheath_manip.dataset.steps import recorded_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from tools.identical import identical
from tools.synthetic import synthetic_episode, synthetic_info

RECORDED = Path(__file__).parent / "store_of_folders.zip"
"""written by version 2222041: two synthetic episodes of 3 steps and 2x2 pixels"""
EPISODES = [synthetic_episode(synthetic_info(7, index), 3, 2) for index in range(2)]


@pytest.fixture
def old(tmp_path: Path) -> EpisodeStore:
    shutil.unpack_archive(RECORDED, tmp_path / "old")
    return EpisodeStore(tmp_path / "old")


def schema(store: EpisodeStore) -> int:
    return json.loads((store.path / MARKER).read_text())["schema"]


def test_they_are_read_as_ever(old: EpisodeStore) -> None:
    assert check(old) == []
    assert all(map(identical, old.episodes(), EPISODES))
    assert [each.length for each in old.infos()] == [3, 3]
    assert schema(old) == 1


def test_what_is_recorded_there_is_an_archive(old: EpisodeStore) -> None:
    new = synthetic_episode(synthetic_info(7, 2), 3, 2)
    old.append(new)
    assert all(map(identical, old.episodes(), [*EPISODES, new]))
    assert check(old) == []
    # So that a version that knows only folders says so, and does not pass over the new ones.
    assert schema(old) == 2
    with pytest.raises(StoreError, match="already holds"):
        old.append(EPISODES[0])
    with pytest.raises(StoreError, match="already holds"):
        old.keep(recorded_of(synthetic_episode(synthetic_info(7, 0), 4, 2)))
    old.keep(recorded_of(EPISODES[0]))
    assert len(old.names()) == 3


def test_merging_makes_archives_of_the_same_files(old: EpisodeStore, tmp_path: Path) -> None:
    new = EpisodeStore.create(tmp_path / "new")
    assert merge([old], new) == Merged(2, 0)
    assert not [entry for entry in new.path.iterdir() if entry.is_dir()]
    for name in old.names():
        files = old.files(name)
        assert new.files(name) == files
        assert all(old.content(name, file) == new.content(name, file) for file in files)
    assert merge([old], new) == Merged(0, 2)
    old.drop(old.names()[0])
    assert len(old.names()) == 1
