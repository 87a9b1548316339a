"""A task's whole experiment, small, comes to the same bytes on whatever runs its episodes."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.learning import PREPARE, Job, next_jobs
from sheath_manip.experiments.workers import run_jobs
from sheath_manip.learning.beforehand import with_final_variant
from sheath_manip.rollout import processes
from sheath_manip.rollout.executing import Executing
from sheath_manip.tasks.table import STUDIES
from tests.rollout.asked import digest
from tests.rollout.two_nodes import two_nodes
from tests.run_files import digests, measured
from tests.waiting import eventually

pytestmark = [
    pytest.mark.soak,
    pytest.mark.timeout(3600),
    # Ray's own start is full of what Python will not have in the future.
    pytest.mark.filterwarnings("default"),
]
TASKS = ("driving", "grasp-clutter", "platformer")
WORKERS = (1, 2, 4)


def found(task: str, directory: Path, executing: Executing) -> list[object]:
    """What a small run of the quick plan left: episodes, checkpoints, results."""
    study = STUDIES[task]
    plan = study.plan("quick").changed(
        schedule={"demonstrations": 2, "false_alarm_episodes": 1, "rounds": 2, "episodes": 2},
        comparison={
            "methods": ("sheath", "random-takeover"),
            "seeds": (0,),
            "evaluation_episodes": 1,
            "final_episodes": 1,
        },
    )
    plan = with_final_variant(study.task, plan)
    store = EpisodeStore.create(directory / "store")
    jobs = [Job(study.task, plan, directory, seed, PREPARE) for seed in plan.comparison.seeds]
    run_jobs(jobs, next_jobs, executing, lambda _: None)
    return [digest(store), digests(directory), measured(directory)]


@pytest.fixture(scope="module", params=TASKS)
def serial(request, tmp_path_factory) -> tuple[str, list[object]]:
    directory = tmp_path_factory.mktemp("serial")
    return request.param, found(request.param, directory, Executing(workers=0))


@pytest.fixture(scope="module")
def nodes() -> Iterator[Any]:
    pytest.importorskip("ray", reason="Ray is not installed: pip install 'sheath-manip[ray]'")
    yield from two_nodes()


def killed_while(run: Callable[[], list[object]], workers: Callable[[], list[int]]) -> list[object]:
    """What `run` finds where the system kills one of its workers in the midst."""
    killed: list[int] = []

    def kill() -> None:
        assert eventually(lambda: bool(workers()), 600)
        killed.append(workers()[0])
        os.kill(killed[0], signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    result = run()
    killer.join()
    assert killed
    return result


def ray_workers() -> list[int]:
    """Process ids of the actors that run an episode now."""
    pids = [int(path.name) for path in Path("/proc").iterdir() if path.name.isdigit()]
    return [pid for pid in pids if _line_of(pid).startswith("ray::Actor.run")]


def _line_of(pid: int) -> str:
    try:
        return (Path("/proc") / str(pid) / "cmdline").read_text()
    except OSError:
        return ""


@pytest.mark.parametrize("workers", WORKERS)
def test_processes_one_of_them_killed(serial, tmp_path, monkeypatch, workers):
    task, wanted = serial
    hired: list[processes.ProcessWorker] = []

    class Noted(processes.ProcessWorker):
        def __init__(self) -> None:
            super().__init__()
            hired.append(self)

    monkeypatch.setattr(processes, "ProcessWorker", Noted)

    def pids() -> list[int]:
        return [pid for each in hired if (pid := each.process.pid) is not None]

    run = killed_while(lambda: found(task, tmp_path, Executing(workers=workers)), pids)
    assert run == wanted
    assert not multiprocessing.active_children()


@pytest.mark.parametrize("workers", WORKERS)
def test_ray_on_two_nodes_one_worker_killed(serial, nodes, tmp_path, workers):
    task, wanted = serial
    executing = Executing("ray", workers, nodes.address)
    assert killed_while(lambda: found(task, tmp_path, executing), ray_workers) == wanted
