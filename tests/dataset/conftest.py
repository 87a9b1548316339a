from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Episode
from tools.kill_recorder import synthetic_episode, synthetic_info


@pytest.fixture
def store(tmp_path: Path) -> EpisodeStore:
    return EpisodeStore.create(tmp_path / "store")


@pytest.fixture
def episode() -> Episode:
    """Longer than one chunk of frames."""
    return synthetic_episode(synthetic_info(run=0, index=0), length=70, pixels=5)
