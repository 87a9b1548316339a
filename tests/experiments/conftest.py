from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Outcome
from tests.experiments.interventions import episode
from tests.writing import writes_here

__all__ = ["writes_here"]


@pytest.fixture
def store(tmp_path: Path) -> EpisodeStore:
    store = EpisodeStore.create(tmp_path / "store")
    for made in (
        episode(0, "p" * 20 + "e" * 12 + "p" * 20, Outcome.FAILURE),
        episode(1, "p" * 20 + "eeee" + "p" * 20),
        episode(2, "p" * 20 + "eeeepeeee" + "p" * 20),
        episode(3, "e" * 15 + "p" * 20),
        episode(4, "p" * 30),
        episode(5, "p" * 20 + "e" * 16 + "p" * 20, method="random-takeover"),
    ):
        store.append(made)
    return store
