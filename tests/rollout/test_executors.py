"""The same requests give the same bytes, in whatever processes and order they run."""

import os
import random
import signal
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, WorkerError
from sheath_manip.learning.drivers import ExpertAlone
from sheath_manip.protocols import Environment
from sheath_manip.rollout.processes import ProcessExecutor, ProcessWorker
from sheath_manip.rollout.request import Crew
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.task import Task
from tests.rollout.asked import digest, requests
from tests.toy import CORRIDOR
from tests.waiting import DEADLINE_S, eventually


@pytest.fixture(scope="module")
def serial(tmp_path_factory) -> str:
    store = EpisodeStore.create(tmp_path_factory.mktemp("serial"))
    with SerialExecutor() as executor:
        episodes = list(executor.map(requests(6), store))
    assert [episode.info.index for episode in episodes] == list(range(6))
    return digest(store)


@pytest.mark.parametrize(
    "workers", [2, *(pytest.param(count, marks=pytest.mark.soak) for count in (1, 4))]
)
def test_so_many_processes_give_the_same_bytes_in_any_order(tmp_path, serial, workers):
    store = EpisodeStore.create(tmp_path)
    shuffled = random.Random(workers).sample(requests(6), 6)
    heard: list[str] = []
    with ProcessExecutor(workers) as executor:
        episodes = list(executor.map(shuffled, store, report=heard.append))
    assert [episode.info for episode in episodes] == [request.info for request in shuffled]
    assert len(heard) == 6
    assert digest(store) == serial


def test_what_the_store_has_is_read_and_not_run_again(tmp_path, serial):
    store = EpisodeStore.create(tmp_path)
    with SerialExecutor() as executor:
        list(executor.map(requests(3), store))
        wrong = requests(6, Failing(at_index=2))
        list(executor.map([*wrong[:3], *requests(6)[3:]], store))
    assert digest(store) == serial


@pytest.fixture(scope="module")
def two() -> Iterator[ProcessExecutor]:
    """Two processes for all tests that do not end them: each takes seconds to start."""
    with ProcessExecutor(2) as executor:
        yield executor


def test_without_a_store_episodes_come_without_images(two):
    (episode,) = two.map(requests(1))
    assert not episode.steps[0].observation.images
    assert episode.steps[0].observation.features.shape == (2,)


@dataclass(frozen=True)
class Slow:
    """The expert, once it was told in a file that it began; it waits while it is the first time."""

    marks: Path

    def crew(self, task: Task, environment: Environment) -> Crew:
        mark = self.marks / f"{os.getpid()}"
        first = not any(self.marks.iterdir())
        mark.touch()
        if first:
            time.sleep(60)
        return ExpertAlone().crew(task, environment)


def test_a_lost_worker_costs_its_episode_and_the_run_goes_on(tmp_path, serial):
    store, marks = EpisodeStore.create(tmp_path / "store"), tmp_path / "marks"
    marks.mkdir()

    def kill_the_first() -> None:
        end_s = time.monotonic() + DEADLINE_S
        while time.monotonic() < end_s:
            for mark in marks.iterdir():
                os.kill(int(mark.name), signal.SIGKILL)
                return
            time.sleep(0.02)

    killer = threading.Thread(target=kill_the_first)
    killer.start()
    with ProcessExecutor(1) as executor:
        episodes = list(executor.map(requests(6, Slow(marks)), store))
    killer.join()
    assert len(episodes) == 6
    assert len(list(marks.iterdir())) == 2
    assert digest(store) == serial


@dataclass(frozen=True)
class Failing:
    """Fails where it is to drive, or takes its process with it."""

    at_index: int = 0
    deadly: bool = False

    def crew(self, task: Task, environment: Environment) -> Crew:
        del task, environment
        if self.deadly:
            os.kill(os.getpid(), signal.SIGKILL)
        raise ZeroDivisionError(f"at {self.at_index}")


def test_an_error_in_a_worker_is_told_in_one_line(two, tmp_path):
    with pytest.raises(
        WorkerError, match=r"^the crew could not be made \(ZeroDivisionError: at 7\)$"
    ):
        list(two.map(requests(1, Failing(7)), EpisodeStore.create(tmp_path)))


@pytest.mark.soak
def test_an_episode_that_kills_every_worker_is_given_up():
    with ProcessExecutor(1) as executor, pytest.raises(WorkerError, match=r"lost 3 workers.*-9"):
        list(executor.map(requests(1, Failing(deadly=True))))


def test_what_cannot_be_pickled_is_told_and_the_next_is_run(two):
    def unnamed(environment):
        return CORRIDOR.expert(environment)

    (request,) = requests(1)
    unsendable = replace(request, task=replace(CORRIDOR, expert=unnamed))
    with pytest.raises(WorkerError, match=r"cannot be sent to a worker.*unnamed.*wanted a dr"):
        list(two.map([unsendable]))
    assert len(list(two.map([request]))) == 1


def test_closed_in_the_midst_whoever_waits_is_told(tmp_path):
    executor = ProcessExecutor(1)

    def close_once_it_runs() -> None:
        eventually(lambda: any(tmp_path.iterdir()))
        executor.close()

    closing = threading.Thread(target=close_once_it_runs)
    closing.start()
    with pytest.raises(WorkerError, match="the executor was closed"):
        list(executor.map(requests(2, Slow(tmp_path))))
    closing.join()


def hired(executor: ProcessExecutor) -> list[ProcessWorker]:
    return [worker for worker in executor._crowd.hired if isinstance(worker, ProcessWorker)]


def test_closing_ends_the_workers_and_nothing_more_is_taken():
    executor = ProcessExecutor(2)
    list(executor.map(requests(2)))
    pids = [worker.process.pid for worker in hired(executor)]
    running = [pid for pid in pids if pid is not None]
    assert running
    executor.close()
    for process in running:
        with pytest.raises(ProcessLookupError):
            os.kill(process, 0)
    with pytest.raises(ParameterError, match="closed"):
        list(executor.map(requests(1)))
    executor.close()


def test_several_threads_may_ask_at_once(two, tmp_path):
    stores = [EpisodeStore.create(tmp_path / name) for name in ("one", "two")]
    threads = [
        threading.Thread(target=lambda at=at: list(two.map(requests(3), at))) for at in stores
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert digest(stores[0]) == digest(stores[1])


def test_what_is_recorded_goes_before_what_only_judges(tmp_path):
    """The next fit waits for the one, and nothing for the other."""
    executor, store = ProcessExecutor(1), EpisodeStore.create(tmp_path)
    # Nobody hands out, so that all stays pending.
    executor._crowd._threads.append(threading.Thread())
    for asked, into in ((requests(2), None), (requests(2), store), (requests(1), None)):
        executor.map(asked, into)
    pending = [(each.recorded, each.errand.request.info.index) for each in executor._crowd._pending]
    assert pending == [(True, 0), (True, 1), (False, 0), (False, 1), (False, 0)]


def test_bad_counts_and_listeners_are_refused():
    with pytest.raises(ParameterError, match="workers is 0"):
        ProcessExecutor(0)
    with ProcessExecutor(1) as executor, pytest.raises(ParameterError, match="listeners"):
        list(executor.map([], listeners=(object(),)))  # pyright: ignore[reportArgumentType]
