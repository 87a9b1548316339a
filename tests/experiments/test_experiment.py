"""A whole experiment on the toy task: its processes, its summary, and what it refuses."""

import io
import json
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError
from sheath_manip.experiments import learning
from sheath_manip.experiments.learning import PREPARE, Job, next_jobs, run_experiment
from sheath_manip.rollout.executing import Executing
from sheath_manip.types.work import Headway
from tests.rollout.two_nodes import two_nodes
from tests.run_files import digests, measured
from tests.toy import PLAN, STUDY

EXPERIMENT = PLAN.changed(
    policy={"name": "hog-svm"},
    gate={"signal": "support", "embedding": "pixels"},
    comparison={
        "methods": ("dagger", "sheath", "random-takeover"),
        "evaluation_episodes": 1,
        "final_episodes": 1,
    },
    schedule={"demonstrations": 2, "false_alarm_episodes": 1, "rounds": 1, "episodes": 1},
)


def experiment(directory: Path, workers: int, plan=EXPERIMENT, **options) -> dict:
    return run_experiment(
        STUDY,
        plan,
        runs=directory / "runs",
        results=directory / "results",
        command="none",
        executing=Executing(workers=workers),
        console=Console(file=io.StringIO()),
        **options,
    )


@pytest.fixture
def _no_figures(monkeypatch) -> None:
    monkeypatch.setattr(learning, "write_figures", lambda *_: [])


@pytest.fixture(scope="module")
def here(tmp_path_factory) -> Path:
    """An experiment in this process."""
    directory = tmp_path_factory.mktemp("here")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(learning, "write_figures", lambda *_: [])
        experiment(directory, workers=0)
    return directory


def summary_of(directory: Path) -> dict:
    """Without what depends on the time of day: others may commit while this runs."""
    summary = json.loads((directory / "results" / "summary.json").read_text())
    return summary | {"wall_s": None, "git": None}


@pytest.mark.soak
@pytest.mark.usefixtures("_no_figures")
def test_two_processes_give_the_numbers_of_one(here, tmp_path):
    experiment(tmp_path, workers=2)
    assert summary_of(tmp_path) == summary_of(here)
    assert digests(tmp_path / "runs") == digests(here / "runs")
    assert measured(tmp_path / "runs") == measured(here / "runs")


@pytest.fixture(scope="module")
def nodes() -> Iterator[Any]:
    pytest.importorskip("ray", reason="Ray is not installed: pip install 'sheath-manip[ray]'")
    yield from two_nodes()


# Ray's own start is full of what Python will not have in the future.
@pytest.mark.filterwarnings("default")
@pytest.mark.soak
@pytest.mark.timeout(1500)
@pytest.mark.usefixtures("_no_figures")
def test_a_cluster_of_two_nodes_gives_the_numbers_of_one_process(here, nodes, tmp_path):
    run_experiment(
        STUDY,
        EXPERIMENT,
        runs=tmp_path / "runs",
        results=tmp_path / "results",
        command="none",
        executing=Executing("ray", 2, nodes.address),
        console=Console(file=io.StringIO()),
    )
    assert summary_of(tmp_path) == summary_of(here)
    assert digests(tmp_path / "runs") == digests(here / "runs")
    assert measured(tmp_path / "runs") == measured(here / "runs")


@pytest.mark.usefixtures("_no_figures")
def test_an_experiment_that_is_done_only_writes_its_summary_again(here, tmp_path):
    shutil.copytree(here, tmp_path / "again")
    (tmp_path / "again" / "results" / "summary.json").unlink()
    before = digests(tmp_path / "again")
    experiment(tmp_path / "again", workers=0)
    assert summary_of(tmp_path / "again") == summary_of(here)
    assert digests(tmp_path / "again") == before


class Follower:
    """A listener that wants to know how far the run is."""

    def __init__(self) -> None:
        self.told: list[Headway] = []

    def on_fit(self, states) -> None: ...

    def on_start(self, environment, info) -> None: ...

    def on_step(self, environment, step) -> None: ...

    def on_end(self, episode) -> None: ...

    def on_headway(self, headway: Headway) -> None:
        self.told.append(headway)


@pytest.mark.usefixtures("_no_figures")
@pytest.mark.parametrize("kept", ["all", "one method", "nothing that was measured"])
def test_a_resumed_run_counts_up_to_the_same_end(here, tmp_path, kept):
    shutil.copytree(here, tmp_path / "run")
    runs = tmp_path / "run" / "runs"
    if kept != "all":
        for path in runs.glob("s*/*/round-*.json"):
            if kept != "one method" or path.parent.name == "sheath":
                path.unlink()
    follower = Follower()
    experiment(tmp_path / "run", workers=0, listeners=[follower])
    *told, end = follower.told
    assert end == Headway(end.units, end.units)
    # Each unit once, and none that was not foreseen.
    assert [each.done for each in told] == list(range(1, end.units + 1))


def test_another_plan_does_not_resume_a_run(here, tmp_path):
    shutil.copytree(here, tmp_path / "run")
    with pytest.raises(
        ParameterError, match=r"another gate\.support\.nu, schedule\.rounds;"
    ) as caught:
        experiment(
            tmp_path / "run",
            0,
            EXPERIMENT.changed(gate={"support": {"nu": 0.1}}, schedule={"rounds": 2}),
        )
    assert "\n" not in str(caught.value)
    assert digests(tmp_path / "run") == digests(here)


@pytest.mark.parametrize(
    ("least", "first", "after_sheath"),
    [
        # What is followed goes first, and what follows it waits beside it.
        (0.0, ["sheath", "dagger", "random-takeover"], []),
        # Where there may be fewer rounds than planned it begins when they are known.
        (0.1, ["sheath", "dagger"], ["random-takeover"]),
    ],
)
def test_what_starts_after_what(tmp_path, least, first, after_sheath):
    plan = EXPERIMENT.changed(schedule={"stop_below_loss": least})
    prepared = Job(STUDY.task, plan, tmp_path, 0, PREPARE)
    assert [job.method for job in next_jobs(prepared)] == first
    followed = replace(prepared, method="sheath")
    assert [job.method for job in next_jobs(followed)] == after_sheath


def test_a_follower_without_the_method_it_follows_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="add sheath to the methods"):
        experiment(tmp_path, 0, EXPERIMENT.changed(comparison={"methods": ("random-takeover",)}))
    assert not (tmp_path / "runs").exists()


def test_listeners_cannot_follow_into_processes(tmp_path):
    with pytest.raises(ParameterError, match="wanted workers 0"):
        experiment(tmp_path, 2, listeners=(Recorder(EpisodeStore.create(tmp_path)),))
