"""Rounds of learning that were stopped or killed resume to the bit."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning import judged
from sheath_manip.learning.checkpoint import Checkpoint
from tests.learning.corridor_run import METHODS, SMALL_PLAN, learn, run, uninterrupted
from tests.run_files import digests, measured
from tests.writing import WriterHere

pytestmark = pytest.mark.usefixtures("small_policy_known")


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    return uninterrupted(tmp_path_factory)


def same(directory: Path, whole: Path, methods: tuple[str, ...] = METHODS) -> bool:
    wanted = ("expert", *methods)

    def of(found: dict) -> dict:
        return {path: value for path, value in found.items() if Path(path).parts[1] in wanted}

    assert digests(directory) == of(digests(whole))
    assert measured(directory) == of(measured(whole))
    store, reference = EpisodeStore(directory / "store"), EpisodeStore(whole / "store")
    infos = [summary.info for summary in reference.infos()]
    assert [e.info for e in store.infos()] == [info for info in infos if info.method in wanted]
    return True


class StoppedError(KeyboardInterrupt):
    """Stands for the power cut."""


class Cutter:
    """Cuts the power around every file once: before it is written, or after."""

    def __init__(self, when: str, patch: pytest.MonkeyPatch) -> None:
        self.when = when
        self.cut: set[str] = set()
        self.written = 0
        self._wrap(patch, WriterHere, "append_arrays", lambda args: str(args[1].header.info))
        self._wrap(patch, Checkpoint, "save", lambda args: str(args[1]))
        self._wrap(patch, judged, "write_result", lambda args: str(args[0]))

    def _wrap(self, patch, owner, name: str, key) -> None:
        write = getattr(owner, name)

        def written(*arguments):
            file = key(arguments)
            if self.when == "before" and file not in self.cut:
                self.cut.add(file)
                raise StoppedError(file)
            made = write(*arguments)
            self.written += 1
            if self.when == "after" and file not in self.cut:
                self.cut.add(file)
                raise StoppedError(file)
            return made

        patch.setattr(owner, name, written)


# What follows a file precedes the next one, but for the last.
@pytest.mark.parametrize("when", ["before", pytest.param("after", marks=pytest.mark.soak)])
def test_stopped_at_any_file_it_resumes_to_the_same_result(when, whole, tmp_path, monkeypatch):
    cutter = Cutter(when, monkeypatch)
    sessions = 0
    while True:
        sessions += 1
        try:
            learn(tmp_path, methods=METHODS[:1])
        except StoppedError:
            continue
        break
    expert = (
        SMALL_PLAN.schedule.demonstrations
        + SMALL_PLAN.schedule.calibration
        + SMALL_PLAN.schedule.false_alarm_episodes
    )
    files = expert + 2 + SMALL_PLAN.schedule.rounds * (SMALL_PLAN.schedule.episodes + 2)
    assert sessions == files + 1
    # Nothing is made twice.
    assert cutter.written == files
    assert same(tmp_path, whole, METHODS[:1])


class Interrupter:
    """A listener that gives up in the midst of some episodes, once in each."""

    def __init__(self) -> None:
        self.seen: list[str] = []
        self.fitted: list[int] = []

    def on_fit(self, states) -> None:
        self.fitted.append(len(states))

    def on_start(self, environment, info) -> None:
        pass

    def on_step(self, environment, step) -> None:
        del step
        place = f"{environment.state()}"
        if environment.state()[0] == 5 and place not in self.seen:
            self.seen.append(place)
            # Some demonstrations, and of each round of each method one episode at least.
            if len(self.seen) % 2:
                raise StoppedError(place)

    def on_end(self, episode) -> None:
        pass


def test_an_episode_that_was_cut_short_is_run_again(whole, tmp_path):
    listener = Interrupter()
    stops = 0
    while True:
        try:
            learn(tmp_path, (listener,))
        except StoppedError:
            stops += 1
            continue
        break
    # Episodes that ended before the fifth step are not among them.
    assert stops >= 5
    assert same(tmp_path, whole)


def test_listeners_hear_of_every_fit(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "run")
    (tmp_path / "run" / "s0" / "sheath" / "round-02.json").unlink()
    listener = Interrupter()
    results = run("sheath", tmp_path / "run", listeners=(listener,))
    assert listener.fitted == [result.states for result in results]
    assert same(tmp_path / "run", whole)


@pytest.mark.soak
def test_killed_it_resumes_to_the_same_result(whole, tmp_path):
    program = (
        "import sys; from pathlib import Path; from tests.learning.corridor_run import learn; "
        "learn(Path(sys.argv[1]))"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", program, str(tmp_path)], env=os.environ | {"OMP_NUM_THREADS": "1"}
    )
    late = time.monotonic() + 200
    while not (tmp_path / "s0" / "sheath" / "round-01.npz").exists():
        assert process.poll() is None
        assert time.monotonic() < late
        time.sleep(0.005)
    process.send_signal(signal.SIGKILL)
    assert process.wait() == -signal.SIGKILL
    assert not (tmp_path / "s0" / "random-takeover").exists()
    learn(tmp_path)
    assert same(tmp_path, whole)


def test_what_was_marked_bad_meanwhile_is_not_learned_from(whole, tmp_path):
    directory = Path(shutil.copytree(whole, tmp_path / "marked"))
    store = EpisodeStore(directory / "store")
    # As if the run had been stopped before the fit of round 1, and a person had looked at it.
    for path in directory.glob("s0/sheath/round-0[12].*"):
        path.unlink()
    labels = 0
    for summary in store.infos():
        if summary.info.method == "sheath" and summary.info.round == 2:
            store.drop(summary.name)
        elif summary.info.method == "sheath" and summary.info.round == 1:
            labels += summary.queries
            store.mark(summary.name, Marks(bad=((0, summary.length),)))
    assert labels
    before = run("sheath", Path(shutil.copytree(whole, tmp_path / "whole")))
    after = run("sheath", directory)
    assert after[1].states == before[1].states - labels == before[0].states
