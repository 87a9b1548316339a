"""A store is looked at while another process writes into it: names come and go in between."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from sheath_manip.dataset.check import check
from sheath_manip.dataset.repair import Repaired, repair
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Episode

GONE = (".tmp-1234", "of-someone")


@pytest.fixture
def store_of_one(store: EpisodeStore, episode: Episode, monkeypatch) -> EpisodeStore:
    """A store whose directory, when it is listed, still has what is gone a moment later."""
    store.append(episode)
    listed = Path.iterdir

    def before(self: Path) -> Iterator[Path]:
        yield from listed(self)
        yield from (self / name for name in GONE)

    monkeypatch.setattr(Path, "iterdir", before)
    return store


def test_what_vanishes_while_it_is_checked_is_no_fault(store_of_one: EpisodeStore) -> None:
    assert check(store_of_one) == []


def test_what_vanishes_while_it_is_repaired_is_left_out(store_of_one: EpisodeStore) -> None:
    assert repair(store_of_one, 0.0) == Repaired((), (), ())


def test_what_vanishes_while_its_age_is_asked_for(store: EpisodeStore, monkeypatch) -> None:
    leftover = store.path / GONE[0]
    leftover.touch()

    def renamed(entry: Path) -> bool:
        entry.unlink(missing_ok=True)
        return False

    monkeypatch.setattr("sheath_manip.dataset.repair.is_folder", renamed)
    assert repair(store, 0.0) == Repaired((), (), ())
