"""Several processes share the workers of one."""

import multiprocessing
from collections.abc import Iterator
from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import WorkerError
from sheath_manip.rollout.crowd import Crowd
from sheath_manip.rollout.elsewhere import CrowdExecutor
from sheath_manip.rollout.shared import Exchange, SharedExecutor
from tests.rollout.asked import digest, requests
from tests.rollout.here_worker import HereWorker


@pytest.fixture
def exchange() -> Iterator[Exchange]:
    with CrowdExecutor(Crowd(2, HereWorker)) as executor, Exchange(executor) as exchange:
        yield exchange


def collect(address: str, path: Path) -> None:
    list(SharedExecutor(address).map(requests(3), EpisodeStore(path)))


def test_children_ask_for_episodes_and_their_parent_runs_them(exchange, tmp_path):
    stores = [EpisodeStore.create(tmp_path / name) for name in ("one", "two", "here")]
    context = multiprocessing.get_context("spawn")
    child = context.Process(target=collect, args=(exchange.address, stores[0].path))
    child.start()
    collect(exchange.address, stores[1].path)
    child.join()
    list(SharedExecutor(exchange.address).map(requests(3), stores[2]))
    assert digest(stores[0]) == digest(stores[1]) == digest(stores[2])


def test_several_askings_are_under_way_at_once(exchange):
    executor = SharedExecutor(exchange.address)
    first, second = executor.map(requests(2)), executor.map(requests(1))
    assert [each.info.index for each in second] == [0]
    assert [each.info.index for each in first] == [0, 1]
    assert list(executor.map([])) == []


def test_without_the_one_that_has_the_workers_it_is_one_line(exchange):
    address = exchange.address
    exchange.close()
    with pytest.raises(WorkerError, match="the process that has the workers is gone"):
        list(SharedExecutor(address).map(requests(1)))
