"""On every task, training, `sheath run` and the page make one gate from a checkpoint."""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sheath_manip.gates import AlwaysExpert
from sheath_manip.gates.fitted import Sources
from sheath_manip.learning.checkpoint import Checkpoint, digest
from sheath_manip.learning.drivers import GatedPolicy
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.policies import make_policy
from sheath_manip.protocols import Environment, Restorable
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.request import EpisodeRequest, run_request
from sheath_manip.task import Task
from sheath_manip.tasks.table import STUDIES, TASKS
from sheath_manip.types import (
    Action,
    Actor,
    Episode,
    EpisodeInfo,
    Observation,
    Outcome,
    Purpose,
    TaskSpec,
    Transition,
)
from sheath_manip.types.samples import samples_from
from tests.deciding import decided, of_the_page, of_the_run, recorded

TRAINED_ON, HELD_OUT, STEPS = 2, 4, 20
TINY: Mapping[str, dict[str, Any]] = {
    "driving": {"name": "plain-cnn", "settings": {"epochs": 1}},
    "gauze-cutting": {"settings": {"spatial_settings": {"steps": 3, "warm_steps": 1}}},
    "grasp-clutter": {"settings": {"steps": 3, "warm_steps": 1}},
    "platformer": {"name": "linear-svm"},
}
"""policies that learn next to nothing, but quickly"""
HOLDING = {"release_margin": 0.001, "quiet_steps": 1, "minimum_hold_steps": 3, "labels": "own"}


class Short:
    """The first steps of a task's episodes."""

    def __init__(self, environment: Environment) -> None:
        self.environment = environment
        self.spec: TaskSpec = environment.spec
        self.done = 0

    def __getattr__(self, name: str) -> Any:
        # What a task's own controllers ask of it.
        return getattr(self.environment, name)

    def reset(self, seed: int) -> Observation:
        self.done = 0
        return self.environment.reset(seed)

    def step(self, action: Action) -> Transition:
        self.done += 1
        transition = self.environment.step(action)
        return replace(transition, truncated=transition.truncated or self.done == STEPS)

    def outcome(self) -> Outcome:
        return self.environment.outcome()

    def metrics(self) -> Mapping[str, float]:
        return self.environment.metrics()

    def state(self) -> NDArray[np.float64]:
        assert isinstance(self.environment, Restorable)
        return self.environment.state()


@pytest.fixture(params=sorted(TINY), scope="module")
def task(request) -> Task:
    return TASKS[request.param]


@pytest.fixture(scope="module")
def environment(task) -> Iterator[Environment]:
    environment = task.make()
    yield environment
    environment.close()


@pytest.fixture(scope="module")
def path(task, environment, tmp_path_factory) -> Path:
    """A checkpoint, fitted as `sheath train` does it; as many states inside as outside."""
    expert = task.expert(environment)

    def demonstrated(seed: int) -> Episode:
        info = EpisodeInfo.of(
            environment.spec, variant="default", seed=seed, purpose=Purpose.DEMONSTRATION
        )
        rng = np.random.default_rng(0)
        short: Any = Short(environment)
        return rollout(short, info, AlwaysExpert(), rng=rng, expert=expert)

    plan = STUDIES[task.name].plans["quick"].changed(policy=TINY[task.name], gate=HOLDING)
    episodes = [demonstrated(seed) for seed in range(TRAINED_ON + HELD_OUT)]
    states = samples_from(episodes[:TRAINED_ON])
    held_out = [samples_from([each]) for each in episodes[TRAINED_ON:]]
    policy = make_policy(plan.policy.name, environment.spec, 0, **plan.policy.settings).fit(states)
    fit = fit_gate(policy, states, held_out, plan.gate, sources=Sources(("a", "b"), ("c",)))
    scores = np.concatenate([fit.gate.scores(each) for each in held_out])
    fitted = replace(fit.gate, threshold=float(np.median(scores[np.isfinite(scores)])))
    made = Checkpoint(task.name, plan.policy.name, policy, fitted)
    return made.save(tmp_path_factory.mktemp(task.name) / "tiny.npz")


def test_all_decide_alike(task, environment, path, monkeypatch, capsys):
    training = GatedPolicy(path, digest(path))
    info = EpisodeInfo.of(
        environment.spec,
        variant="default",
        seed=50,
        purpose=Purpose.LEARNING,
        method="sheath-own-labels",
        checkpoint=digest(path),
    )
    short: Any = Short(environment)
    crew = training.crew(task, environment)
    episode = run_request(EpisodeRequest(task, info, training), short, crew)
    wanted = recorded(episode)
    assert len(wanted) == STEPS
    for step in episode.steps:
        assert step.decision.query is (step.decision.actor is Actor.EXPERT)
    run = of_the_run(task, path, monkeypatch)
    capsys.readouterr()
    assert run == training
    for driver in (run, of_the_page(path, environment)):
        assert decided(driver, task, environment, episode) == wanted
