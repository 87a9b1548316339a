"""A policy may still be judged while the next round is collected: the results are the same."""

import shutil
from pathlib import Path
from typing import ClassVar

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.run import LearningRun
from sheath_manip.rollout.executor import Executor
from sheath_manip.rollout.processes import ProcessExecutor
from sheath_manip.rollout.serial import SerialExecutor
from tests.learning.corridor_run import SMALL_PLAN
from tests.run_files import digests, measured
from tests.toy import CORRIDOR

PLAN = SMALL_PLAN.changed(
    policy={"name": "hog-svm"}, gate={"signal": "support", "embedding": "pixels"}
)
"""without a network to train"""


class Late(SerialExecutor):
    """Judges as late as it may."""

    overlaps: ClassVar[bool] = True


def learned(directory: Path, executor: Executor) -> list[str]:
    """All rounds of `sheath`, and what was heard of them."""
    heard: list[str] = []
    store = EpisodeStore.create(directory / "store")
    run = LearningRun(CORRIDOR, PLAN, 0, directory, store, executor, report=heard.append)
    run.run("sheath")
    return heard


def judged_in_round_2(heard: list[str]) -> int:
    """How many episodes judged the policy of round 1 after round 2 had begun."""
    return heard[heard.index("sheath round 2") :].count("sheath round 1")


@pytest.fixture(scope="module")
def at_once(tmp_path_factory, writes_here) -> Path:
    """A run whose policies are judged before the next round."""
    del writes_here
    directory = tmp_path_factory.mktemp("at-once")
    with SerialExecutor() as executor:
        assert judged_in_round_2(learned(directory, executor)) == 0
    return directory


def test_judged_late_it_comes_to_the_same(at_once, tmp_path) -> None:
    with Late() as executor:
        heard = learned(tmp_path, executor)
    assert judged_in_round_2(heard) == PLAN.comparison.evaluation_episodes
    assert digests(tmp_path) == digests(at_once)
    assert measured(tmp_path) == measured(at_once)


@pytest.mark.parametrize("left", [(), ("round-01.json",)])
def test_stopped_while_it_was_judged_it_resumes_to_the_same(at_once, tmp_path, left) -> None:
    """The next round may be there already."""
    again = tmp_path / "again"
    shutil.copytree(at_once, again)
    for path in (again / "s0" / "sheath").glob("*.json"):
        if path.name not in left:
            path.unlink()
    with Late() as executor:
        learned(again, executor)
    assert measured(again) == measured(at_once)


@pytest.mark.soak
def test_worker_processes_come_to_the_same(at_once, tmp_path) -> None:
    with ProcessExecutor(2) as executor:
        learned(tmp_path, executor)
    assert digests(tmp_path) == digests(at_once)
    assert measured(tmp_path) == measured(at_once)
