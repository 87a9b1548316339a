"""Rounds of learning on the toy task: they resume to the bit and never learn from what judges."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import nullcontext
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, SheathError
from sheath_manip.learning import run as learning_run
from sheath_manip.learning.checkpoint import Checkpoint, digest, load_checkpoint
from sheath_manip.learning.results import RoundResult, round_path, round_results
from sheath_manip.learning.run import LearningRun
from sheath_manip.metrics import expert_share
from sheath_manip.policies import POLICIES
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.protocols import Listener
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.types import Actor, Purpose
from tests.run_files import digests, measured
from tests.toy import CORRIDOR, PLAN, Corridor
from tests.writing import WriterHere

SMALL = "small-cnn"
METHODS = ("sheath", "random-takeover")
SMALL_PLAN = PLAN.changed(
    policy={"name": SMALL},
    gate={"embedding": "pooled-convolutions", "threshold": {"false_alarm_rate": 0.3}},
    comparison={"methods": METHODS},
    schedule={"demonstrations": 3, "false_alarm_episodes": 1},
)
BEGUN = "round-00.npz"
"""the first policy under the method's own gate, where that is not the plan's"""
FILES = ["round-01.json", "round-01.npz", "round-02.json", "round-02.npz"]


def small_policy() -> Callable[..., ConvPolicy]:
    return partial(ConvPolicy, channels=(8,), hidden=(16,), epochs=8)


def run(
    method: str, directory: Path, plan=SMALL_PLAN, report=lambda _: None, listeners=()
) -> list[RoundResult]:
    store = EpisodeStore.create(directory / "store")
    with SerialExecutor() as executor:
        learning = LearningRun(CORRIDOR, plan, 0, directory, store, executor, listeners, report)
        return learning.run(method)


def learn(
    directory: Path, listeners: tuple[Listener, ...] = (), methods: tuple[str, ...] = METHODS
) -> None:
    """All rounds of `methods`; also what the killed process runs."""
    small = nullcontext() if SMALL in POLICIES else POLICIES.including(SMALL, small_policy())
    # As in an experiment: another number of threads adds up in another order.
    with small, single_threaded():
        for method in methods:
            run(method, directory, listeners=listeners)


@pytest.fixture(scope="module", autouse=True)
def _small_policy() -> Iterator[None]:
    with POLICIES.including(SMALL, small_policy()):
        yield


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """A run that nothing interrupted."""
    directory = tmp_path_factory.mktemp("whole")
    learn(directory)
    return directory


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


def test_every_round_leaves_its_checkpoint_and_its_result(whole):
    runs = whole / "s0"
    assert sorted(path.name for path in runs.iterdir()) == ["expert", *sorted(METHODS)]
    assert sorted(path.name for path in (runs / "expert").iterdir()) == [
        "round-00.json",
        "round-00.npz",
    ]
    for method in METHODS:
        begun = [] if method == "sheath" else [BEGUN]
        assert sorted(path.name for path in (runs / method).iterdir()) == [*begun, *FILES]
        results = round_results(whole, 0, method)
        assert [result.round for result in results] == [0, 1, 2]
        assert [result.method for result in results] == ["expert", method, method]
        for result in results:
            name = f"round-{result.round:02d}.npz"
            assert result.checkpoint == digest(runs / result.method / name)
            checkpoint = load_checkpoint(runs / result.method / name, Corridor().spec)
            assert (checkpoint.round, checkpoint.method) == (result.round, result.method)
            np.testing.assert_equal(checkpoint.threshold, result.threshold)
        assert [len(result.final) for result in results] == [
            0,
            0,
            SMALL_PLAN.comparison.final_episodes,
        ]


def test_states_are_aggregated(whole):
    for method in METHODS:
        results = round_results(whole, 0, method)
        steps = [sum(record.steps for record in result.executed) for result in results]
        states = [result.states for result in results]
        assert states == [sum(steps[: number + 1]) for number in range(3)]


def test_the_policy_that_drove_is_the_one_fitted_the_round_before(whole):
    store = EpisodeStore(whole / "store")
    for method in METHODS:
        before = [result.checkpoint for result in round_results(whole, 0, method)]
        if method != "sheath":
            shared, begun = (round_path(whole, 0, name, 0, "npz") for name in ("expert", method))
            first, own = (load_checkpoint(path, Corridor().spec) for path in (shared, begun))
            for key, array in first.policy.arrays().items():
                np.testing.assert_array_equal(own.policy.arrays()[key], array)
            before[0] = digest(begun)
        for number in (1, 2):
            drove = {e.info.checkpoint for e in store.episodes(method=method, round=number)}
            assert drove == {before[number - 1]}


def test_sheath_hands_over_and_random_takeover_gets_its_share(whole):
    store = EpisodeStore(whole / "store")
    actors = {step.decision.actor for e in store.episodes(method="sheath") for step in e.steps}
    assert actors == {Actor.POLICY, Actor.EXPERT}
    for sheath, random in zip(*(round_results(whole, 0, name) for name in METHODS), strict=True):
        share = expert_share(sheath.executed)
        steps = sum(record.steps for record in random.executed)
        # Three standard deviations of the drawn share.
        spread = 3 * (share * (1 - share) / steps) ** 0.5
        assert expert_share(random.executed) == pytest.approx(share, abs=spread + 1e-9)


def test_no_scene_that_judges_is_ever_trained_on(whole):
    store = EpisodeStore(whole / "store")
    by_purpose: dict[Purpose, set[int]] = {purpose: set() for purpose in Purpose}
    for summary in store.infos():
        by_purpose[summary.info.purpose].add(summary.info.seed)
    # Evaluation is not recorded: nothing of it can be learned from.
    assert by_purpose[Purpose.EVALUATION] == set()
    judged = {
        record.seed
        for method in METHODS
        for result in round_results(whole, 0, method)
        for record in (*result.policy, *result.final)
    }
    trained = by_purpose[Purpose.DEMONSTRATION] | by_purpose[Purpose.LEARNING]
    assert len(judged) == SMALL_PLAN.comparison.evaluation_episodes
    assert (
        len(trained)
        == SMALL_PLAN.schedule.demonstrations
        + SMALL_PLAN.schedule.rounds * SMALL_PLAN.schedule.episodes
    )
    assert (
        len(by_purpose[Purpose.CALIBRATION])
        == SMALL_PLAN.schedule.calibration + SMALL_PLAN.schedule.false_alarm_episodes
    )
    assert not judged & trained
    assert not judged & by_purpose[Purpose.CALIBRATION]
    assert not trained & by_purpose[Purpose.CALIBRATION]


def test_all_methods_meet_the_same_scenes(whole):
    for results in zip(*(round_results(whole, 0, name) for name in METHODS), strict=True):
        for part in ("executed", "policy", "final"):
            first, second = ([record.seed for record in getattr(r, part)] for r in results)
            assert first == second


class StoppedError(Exception):
    """Stands for the power cut."""


class Cutter:
    """Cuts the power around every file once: before it is written, or after."""

    def __init__(self, when: str, patch: pytest.MonkeyPatch) -> None:
        self.when = when
        self.cut: set[str] = set()
        self.written = 0
        self._wrap(patch, WriterHere, "append_arrays", lambda args: str(args[1].header.info))
        self._wrap(patch, Checkpoint, "save", lambda args: str(args[1]))
        self._wrap(patch, learning_run, "write_result", lambda args: str(args[0]))

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


@pytest.mark.parametrize("when", ["before", "after"])
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
        "import sys; from pathlib import Path; from tests.learning.test_learning_run import learn; "
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


def test_a_finished_method_is_read_and_not_run(whole):
    for method in METHODS:
        reports: list[str] = []
        results = run(method, whole, report=reports.append)
        assert reports == []
        assert results == round_results(whole, 0, method)


def test_random_takeover_without_sheath_says_what_is_missing(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "run")
    for method in METHODS:
        shutil.rmtree(tmp_path / "run" / "s0" / method)
    with pytest.raises(ParameterError, match="run sheath first") as caught:
        run("random-takeover", tmp_path / "run")
    assert "\n" not in str(caught.value)


def test_an_unknown_method_is_named(tmp_path):
    with pytest.raises(SheathError, match="unknown method 'shaeth'"):
        run("shaeth", tmp_path)


def test_rounds_end_once_the_loss_is_low_enough(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "run")
    plan = SMALL_PLAN.changed(schedule={"stop_below_loss": 1.1})
    for _ in range(2):
        results = run("dagger", tmp_path / "run", plan)
        assert [result.round for result in results] == [0, 1]
        assert len(results[-1].final) == plan.comparison.final_episodes
    names = sorted(path.name for path in (tmp_path / "run" / "s0" / "dagger").iterdir())
    assert names == [BEGUN, *FILES[:2]]


def test_a_method_that_follows_one_that_stopped_stops_with_it(whole, tmp_path):
    shutil.copytree(whole, tmp_path / "run")
    for method in METHODS:
        shutil.rmtree(tmp_path / "run" / "s0" / method)
    run("sheath", tmp_path / "run", SMALL_PLAN.changed(schedule={"stop_below_loss": 1.1}))
    # What random takeover meets where its own loss is not low enough yet.
    results = run("random-takeover", tmp_path / "run")
    assert [result.round for result in results] == [0, 1]
