"""The expert's episodes of every task are the same to the byte, in whatever process they run."""

import random

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.rollout.processes import ProcessExecutor
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import EpisodeInfo, Purpose
from tests.rollout.asked import digest


def requests(name: str, count: int) -> list[EpisodeRequest]:
    task = TASKS[name]
    environment = task.make()
    environment.close()
    infos = [
        EpisodeInfo.of(
            environment.spec,
            variant="default",
            seed=500 + index,
            purpose=Purpose.DEMONSTRATION,
            method="expert",
            index=index,
        )
        for index in range(count)
    ]
    return [EpisodeRequest(task, info, ExpertAlone()) for info in infos]


@pytest.mark.soak
@pytest.mark.parametrize("name", sorted(TASKS))
def test_one_two_and_four_processes_give_the_same_bytes_as_this_one(name, tmp_path):
    asked = requests(name, 5)
    here = EpisodeStore.create(tmp_path / "here")
    with SerialExecutor() as executor:
        list(executor.map(asked, here))
    for workers in (1, 2, 4):
        store = EpisodeStore.create(tmp_path / str(workers))
        with ProcessExecutor(workers) as executor:
            list(executor.map(random.Random(workers).sample(asked, len(asked)), store))
        assert digest(store) == digest(here)


# The sheet takes as long as the other three together.
@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.soak) if name == "gauze-cutting" else name
        for name in sorted(TASKS)
    ],
)
def test_another_process_gives_the_same_bytes(name, tmp_path):
    # One episode: gauze takes ten seconds for it. Many, in shuffled order, are the soak's.
    asked = requests(name, 1)
    stores = [EpisodeStore.create(tmp_path / place) for place in ("here", "there")]
    with SerialExecutor() as here, ProcessExecutor(1) as there:
        list(here.map(asked, stores[0]))
        list(there.map(asked, stores[1]))
    assert digest(stores[0]) == digest(stores[1])
