"""Episodes on a cluster: what travels, what comes back, and what a lost worker costs."""

import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, SetupError, WorkerError
from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.protocols import Environment
from sheath_manip.rollout import cluster
from sheath_manip.rollout.cluster import RayExecutor
from sheath_manip.rollout.request import Crew
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.task import Task
from tests.rollout.asked import digest, requests
from tests.rollout.ray_here import RayHere, lose
from tests.waiting import eventually


@pytest.fixture
def ray(monkeypatch) -> RayHere:
    here = RayHere()
    monkeypatch.delenv("RAY_ADDRESS", raising=False)
    monkeypatch.setitem(sys.modules, "ray", here)  # pyright: ignore[reportArgumentType]
    return here


@pytest.fixture
def two(ray) -> Iterator[RayExecutor]:
    del ray
    with RayExecutor(2) as executor:
        yield executor


@pytest.fixture(scope="module")
def serial(tmp_path_factory) -> str:
    store = EpisodeStore.create(tmp_path_factory.mktemp("serial"))
    with SerialExecutor() as executor:
        list(executor.map(requests(4), store))
    return digest(store)


def test_recorded_episodes_come_back_and_are_written_here(two, serial, tmp_path):
    store = EpisodeStore.create(tmp_path)
    heard: list[str] = []
    asked = requests(4)
    episodes = list(two.map(asked, store, report=heard.append))
    assert [episode.info for episode in episodes] == [request.info for request in asked]
    assert heard == ["expert round 0"] * 4
    assert digest(store) == serial


def test_without_a_store_no_image_travels(two):
    (episode,) = two.map(requests(1))
    assert not episode.steps[0].observation.images
    assert len(episode) > 1


@dataclass(frozen=True)
class FromFile:
    """The expert, where the file of its checkpoint says so; it notes where it found that."""

    checkpoint: Path
    digest: str
    seen: Path

    def crew(self, task: Task, environment: Environment) -> Crew:
        assert self.checkpoint.read_text() == "drive on"
        with self.seen.open("a") as file:
            file.write(f"{self.checkpoint}\n")
        return ExpertAlone().crew(task, environment)


def test_a_checkpoint_travels_once_and_is_read_once_by_each_worker(ray, tmp_path):
    file, seen = tmp_path / "round-01.npz", tmp_path / "seen"
    file.write_text("drive on")
    with RayExecutor(1) as executor:
        list(executor.map(requests(3, FromFile(file, "abc", seen))))
    assert len(ray.put_in) == 1
    (read_at,) = seen.read_text().splitlines()
    assert Path(read_at) != file
    assert Path(read_at).parent == Path(tempfile.gettempdir())
    assert not Path(read_at).exists()


@dataclass(frozen=True)
class Waiting:
    """The expert, once a file is there; it notes that it began."""

    began: Path
    go: Path

    def crew(self, task: Task, environment: Environment) -> Crew:
        self.began.touch()
        eventually(self.go.exists)
        return ExpertAlone().crew(task, environment)


def test_a_lost_worker_costs_its_episodes_only(ray, serial, tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    began, go = tmp_path / "began", tmp_path / "go"

    def lose_the_first() -> None:
        eventually(began.exists)
        lose(ray.handles[0])
        go.touch()

    losing = threading.Thread(target=lose_the_first)
    losing.start()
    with RayExecutor(1) as executor:
        list(executor.map(requests(4, Waiting(began, go)), store))
    losing.join()
    assert len(ray.handles) == 2
    assert digest(store) == serial


@dataclass(frozen=True)
class Failing:
    def crew(self, task: Task, environment: Environment) -> Crew:
        del task, environment
        raise ZeroDivisionError("no way")


def test_an_error_there_is_one_line_here(two):
    with pytest.raises(WorkerError, match=r"^the crew could not be made \(ZeroDivisionError"):
        list(two.map(requests(1, Failing())))


def test_a_machine_with_other_versions_is_refused(ray, monkeypatch):
    here = cluster.versions()
    theirs = iter([here | {"numpy": "1.0"}])
    monkeypatch.setattr(cluster.Actor, "versions", lambda _: next(theirs))
    with (
        RayExecutor(1) as executor,
        pytest.raises(WorkerError, match=rf"has numpy 1\.0; wanted {here['numpy']}, as here"),
    ):
        list(executor.map(requests(1)))
    del ray


def test_a_worker_that_has_no_core_yet_holds_nothing_up(ray, monkeypatch, caplog):
    """Of two only one is ever there; what it cannot do at once waits for it."""
    monkeypatch.setattr(cluster, "PATIENCE_S", 0.01)
    versions = cluster.Actor.versions

    def late(actor) -> object:
        if actor is ray.handles[0].instance:
            time.sleep(60)
        return versions(actor)

    monkeypatch.setattr(cluster.Actor, "versions", late)
    with RayExecutor(2) as executor:
        assert len(list(executor.map(requests(3)))) == 3
    assert "waits for a free core" in caplog.text


def test_workers_are_as_many_as_the_cluster_has_cores(ray):
    ray.cores = 3
    with RayExecutor(address="desktop:6379") as executor:
        assert executor._crowd.workers == 3
    assert ray.connected == [("desktop:6379", None), ()]


def test_without_an_address_the_cluster_is_this_machine(ray, monkeypatch):
    RayExecutor(2).close()
    monkeypatch.setenv("RAY_ADDRESS", "head:6379")
    RayExecutor(2).close()
    assert ray.connected == [("local", 2), (), ("head:6379", None), ()]


def test_without_ray_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(SetupError, match=r"pip install 'sheath-manip\[ray\]'"):
        RayExecutor(2)


def test_no_cluster_at_the_address_is_one_line(ray, monkeypatch):
    def refuse(address: str, **_: object) -> None:
        raise ConnectionError(f"{address} is silent\nand more")

    monkeypatch.setattr(ray, "init", refuse)
    with pytest.raises(SetupError, match=r"^no cluster of Ray at here:1 \(here:1 is silent\); wan"):
        RayExecutor(2, "here:1")


def test_fewer_workers_than_one_are_refused(ray):
    del ray
    with pytest.raises(ParameterError, match="workers is 0"):
        RayExecutor(0)
