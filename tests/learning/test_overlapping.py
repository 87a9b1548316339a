"""A policy may still be judged while the next round is collected: the results are the same."""

import shutil
import threading
import time
from pathlib import Path
from typing import ClassVar

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.run import LearningRun
from sheath_manip.rollout.crowd import Crowd
from sheath_manip.rollout.elsewhere import CrowdExecutor
from sheath_manip.rollout.executor import Executor
from sheath_manip.rollout.processes import ProcessExecutor
from sheath_manip.rollout.serial import SerialExecutor
from tests.learning.corridor_run import SMALL_PLAN
from tests.rollout.here_worker import HereWorker
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


def test_workers_that_run_ahead_come_to_the_same(at_once, tmp_path) -> None:
    """A round's episodes are asked for before the one before is measured."""
    with CrowdExecutor(Crowd(2, HereWorker)) as executor:
        learned(tmp_path, executor)
    assert digests(tmp_path) == digests(at_once)
    assert measured(tmp_path) == measured(at_once)


def test_beside_the_method_that_it_follows_a_method_waits_for_its_rounds(at_once, tmp_path) -> None:
    after, beside = tmp_path / "after", tmp_path / "beside"
    for directory in (after, beside):
        shutil.copytree(at_once, directory)
    # That one has only begun: its episodes come one by one, and its results not at all.
    for path in (beside / "s0" / "sheath").glob("round-*.json"):
        path.unlink()
    followed = sorted((beside / "store").glob("learning-sheath-*"))
    assert followed
    held_back = [path.rename(tmp_path / path.name) for path in followed]

    def give() -> None:
        for path, place in zip(held_back, followed, strict=True):
            time.sleep(0.05)
            path.rename(place)

    giving = threading.Thread(target=give)
    giving.start()
    for directory, awaits in ((beside, True), (after, False)):
        store = EpisodeStore(directory / "store")
        with SerialExecutor() as executor:
            run = LearningRun(CORRIDOR, PLAN, 0, directory, store, executor, awaits=awaits)
            run.run("random-takeover")
    giving.join()
    assert digests(beside) == digests(after)
    own = {name: each for name, each in measured(after).items() if "sheath" not in name}
    assert len(own) > 1
    assert measured(beside) == own


@pytest.mark.soak
def test_worker_processes_come_to_the_same(at_once, tmp_path) -> None:
    with ProcessExecutor(2) as executor:
        learned(tmp_path, executor)
    assert digests(tmp_path) == digests(at_once)
    assert measured(tmp_path) == measured(at_once)
