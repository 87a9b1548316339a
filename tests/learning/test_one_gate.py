"""The gate that a checkpoint was trained with is the one that everybody makes from it."""

import json
import math
import shutil
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.experiments.gates.loop import GateOfRow
from sheath_manip.experiments.gates.plan import GatesPlan
from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.experiments.study import Study
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.drivers import GatedPolicy
from sheath_manip.learning.methods import METHODS
from sheath_manip.learning.results import round_path
from sheath_manip.learning.run import LearningRun
from sheath_manip.protocols import Environment
from sheath_manip.rollout.executor import unheard
from sheath_manip.rollout.request import Driver, EpisodeRequest
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.types import Actor, Episode, Purpose, Reason
from tests.deciding import decided, of_the_page, of_the_run, recorded
from tests.toy import CORRIDOR, PLAN, STUDY

# What is followed comes first.
ORDER = sorted(METHODS, key=lambda name: METHODS[name].burden_from is not None)
SMALL = PLAN.changed(
    policy={"name": "hog-svm"},
    gate={
        "embedding": "pixels",
        "precedent_embedding": "pixels",
        "release_margin": 0.01,
        "quiet_steps": 1,
        "minimum_hold_steps": 3,
        "threshold": {"false_alarm_rate": 0.3, "expert_budget": 0.3},
    },
    comparison={"evaluation_episodes": 1, "final_episodes": 1},
    schedule={"demonstrations": 2, "false_alarm_episodes": 1, "rounds": 2, "episodes": 2},
)


class Watched(SerialExecutor):
    """Remembers what it was asked for."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: list[EpisodeRequest] = []

    def map(
        self,
        requests: Iterable[EpisodeRequest],
        store: EpisodeStore | None = None,
        listeners: Sequence = (),
        report=unheard,
    ) -> Iterator[Episode]:
        asked = list(requests)
        self.asked += asked
        yield from super().map(asked, store, listeners, report)

    def drivers(self, method: str) -> dict[int, Driver]:
        """By round, of the learning episodes."""
        return {
            each.info.round: each.driver
            for each in self.asked
            if each.info.purpose is Purpose.LEARNING and each.info.method == method
        }


def learn(directory: Path, plan: LearningPlan, method: str) -> dict[int, Driver]:
    """All rounds of the method; what drove each of them."""
    store = EpisodeStore.create(directory / "store")
    with Watched() as executor:
        LearningRun(CORRIDOR, plan, 0, directory, store, executor).run(method)
        return executor.drivers(method)


@dataclass(frozen=True)
class Learned:
    """What a run of learning left."""

    directory: Path
    plan: LearningPlan
    drivers: dict[str, dict[int, Driver]]
    """by method and round"""

    def episodes(self, method: str, number: int) -> list[Episode]:
        store = EpisodeStore(self.directory / "store")
        return list(store.episodes(Purpose.LEARNING, method, number))


@pytest.fixture(scope="module")
def learned(tmp_path_factory) -> Learned:
    """Every method."""
    directory = tmp_path_factory.mktemp("learned")
    return Learned(directory, SMALL, {name: learn(directory, SMALL, name) for name in ORDER})


@pytest.fixture
def corridor() -> Environment:
    return CORRIDOR.make()


def of_the_benchmark(study: Study, path: Path, environment: Environment, runs: Path) -> Driver:
    """The row of the gates' benchmark that has this checkpoint, at the checkpoint's threshold."""
    setting = Setting(study, GatesPlan(rates=(0.1,)), runs, 0)
    threshold = load_checkpoint(path, environment.spec).threshold
    row = setting.checkpoint_path("row")
    row.parent.mkdir(parents=True)
    shutil.copy(path, row)
    setting.offline_path("row").write_text(json.dumps({"thresholds": {"0.1": threshold}}))
    return GateOfRow(setting, "row", 0)


@pytest.mark.parametrize("name", ORDER)
def test_all_gates_of_a_checkpoint_decide_as_the_one_that_it_was_trained_with(
    name, learned, corridor, tmp_path, monkeypatch
):
    for number, driver in learned.drivers[name].items():
        assert isinstance(driver, GatedPolicy)
        path = driver.checkpoint
        run = of_the_run(CORRIDOR, path, monkeypatch)
        page = of_the_page(path, corridor)
        others = [driver, run]
        if METHODS[name].uses_signal(SMALL):
            runs = tmp_path / str(number)
            others.append(of_the_benchmark(STUDY, path, corridor, runs))
        for episode in learned.episodes(name, number):
            wanted = recorded(episode)
            for other in others:
                assert decided(other, CORRIDOR, corridor, episode) == wanted
            # On the page a real person takes over, and nobody stands in for it.
            alone = replace(driver, watched_by=None)
            assert decided(page, CORRIDOR, corridor, episode) == decided(
                alone, CORRIDOR, corridor, episode
            )
            if name != "hg-dagger":
                assert decided(page, CORRIDOR, corridor, episode) == wanted


@pytest.mark.parametrize("name", ORDER)
def test_resumed_a_round_is_driven_by_the_same(name, learned):
    # As if it had been killed before the last result was written.
    round_path(learned.directory, 0, name, 2, "json").unlink()
    assert learn(learned.directory, SMALL, name) == learned.drivers[name]


def test_the_settings_of_a_takeover_are_those_of_training(learned):
    """Not so short a takeover as a gate of the defaults would have."""
    held = 0
    for number in (1, 2):
        for name in ("sheath", "sheath-own-labels", "lazy-dagger"):
            for episode in learned.episodes(name, number):
                acts = [step.decision.actor is Actor.EXPERT for step in episode.steps]
                held += sum(step.decision.reason is Reason.HOLD for step in episode.steps)
                starts = [i for i, act in enumerate(acts) if act and not (i and acts[i - 1])]
                for start in starts:
                    assert all(acts[start : start + SMALL.gate.minimum_hold_steps])
    assert held


def test_own_labels_are_asked_for_from_the_first_round_on(learned):
    for number in (1, 2):
        for episode in learned.episodes("sheath-own-labels", number):
            for step in episode.steps:
                assert step.decision.query is (step.decision.actor is Actor.EXPERT)


def test_the_share_of_a_schedule_lies_in_the_checkpoint(learned, corridor):
    for number, driver in learned.drivers["dagger-beta"].items():
        assert isinstance(driver, GatedPolicy)
        config = load_checkpoint(driver.checkpoint, corridor.spec).fitted.config
        assert config.expert_share == SMALL.schedule.beta**number


def test_a_familiar_state_with_a_strange_action_is_an_in_support_risk_while_learning(learned):
    """What the joined signal is for: it was never said while gates were made in three ways."""
    reasons = {
        step.decision.reason
        for name in ("sheath", "sheath-own-labels")
        for number in (1, 2)
        for episode in learned.episodes(name, number)
        for step in episode.steps
    }
    assert {Reason.RISK, Reason.INSIDE} <= reasons


def test_where_there_is_no_score_there_is_none_anywhere(learned, corridor):
    for name in ORDER:
        if not METHODS[name].uses_signal(SMALL):
            for episode in learned.episodes(name, 1):
                assert all(math.isnan(step.decision.score) for step in episode.steps)
    path = round_path(learned.directory, 0, "dagger", 2, "npz")
    assert math.isnan(load_checkpoint(path, corridor.spec).threshold)
