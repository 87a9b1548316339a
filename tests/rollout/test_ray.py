"""A cluster of Ray as it is: several nodes on this machine, and workers and nodes that are lost."""

import os
import signal
import threading
from dataclasses import dataclass
from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.protocols import Environment
from sheath_manip.rollout.cluster import RayExecutor
from sheath_manip.rollout.request import Crew
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.task import Task
from tests.rollout.asked import digest, requests
from tests.rollout.two_nodes import two_nodes
from tests.waiting import eventually

pytest.importorskip("ray", reason="Ray is not installed: pip install 'sheath-manip[ray]'")
pytestmark = [
    pytest.mark.soak,
    # Ray's own start is full of what Python will not have in the future.
    pytest.mark.filterwarnings("default"),
]

COUNT = 8
nodes = pytest.fixture(scope="module")(two_nodes)


@pytest.fixture(scope="module")
def serial(tmp_path_factory) -> str:
    store = EpisodeStore.create(tmp_path_factory.mktemp("serial"))
    with SerialExecutor() as executor:
        list(executor.map(requests(COUNT), store))
    return digest(store)


@dataclass(frozen=True)
class Marking:
    """The expert; it notes its process, and the first one of all waits to be killed."""

    marks: Path

    def crew(self, task: Task, environment: Environment) -> Crew:
        first = not any(self.marks.iterdir())
        (self.marks / f"{os.getpid()}").touch()
        if first:
            eventually(lambda: False, 200)
        return ExpertAlone().crew(task, environment)


@pytest.mark.timeout(600)
@pytest.mark.parametrize("workers", [1, 2, 4])
def test_workers_on_two_nodes_give_the_bytes_of_one_process(nodes, serial, tmp_path, workers):
    store = EpisodeStore.create(tmp_path)
    with RayExecutor(workers, nodes.address) as executor:
        episodes = list(executor.map(requests(COUNT), store))
    assert [episode.info.index for episode in episodes] == list(range(COUNT))
    assert digest(store) == serial


@pytest.mark.timeout(600)
def test_a_worker_killed_by_the_system_costs_its_episode_only(nodes, serial, tmp_path):
    store, marks = EpisodeStore.create(tmp_path / "store"), tmp_path / "marks"
    marks.mkdir()

    def kill_the_first() -> None:
        assert eventually(lambda: any(marks.iterdir()), 200)
        (mark,) = marks.iterdir()
        os.kill(int(mark.name), signal.SIGKILL)

    killer = threading.Thread(target=kill_the_first)
    killer.start()
    with RayExecutor(1, nodes.address) as executor:
        list(executor.map(requests(COUNT, Marking(marks)), store))
    killer.join()
    assert len(list(marks.iterdir())) == 2
    assert digest(store) == serial


@pytest.mark.timeout(600)
def test_a_node_that_goes_takes_its_episodes_only(nodes, serial, tmp_path):
    store, heard = EpisodeStore.create(tmp_path), list[str]()
    lost = nodes.add_node(num_cpus=1, object_store_memory=100 * 2**20)
    with RayExecutor(5, nodes.address) as executor:
        episodes = executor.map(requests(COUNT), store, report=heard.append)
        next(episodes)
        nodes.remove_node(lost, allow_graceful=False)
        list(episodes)
    assert len(heard) == COUNT
    assert digest(store) == serial
