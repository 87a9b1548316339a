from collections.abc import Mapping
from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Episode, TaskSpec
from tests.toy import Corridor
from tools.synthetic import synthetic_episode, synthetic_info


@pytest.fixture(scope="session")
def specs() -> Mapping[str, TaskSpec]:
    """What every task looks like, and the toy one."""
    found = {"corridor": Corridor().spec}
    for name, task in TASKS.items():
        environment = task.make()
        found[name] = environment.spec
        environment.close()
    return found


@pytest.fixture
def store(tmp_path: Path) -> EpisodeStore:
    return EpisodeStore.create(tmp_path / "store")


@pytest.fixture
def episode() -> Episode:
    """Longer than one chunk of frames."""
    return synthetic_episode(synthetic_info(run=0, index=0), length=70, pixels=5)
