"""Rounds of learning on the toy task, with a policy small enough for them."""

from collections.abc import Callable
from contextlib import nullcontext
from functools import partial
from pathlib import Path

import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.results import RoundResult
from sheath_manip.learning.run import LearningRun
from sheath_manip.policies import POLICIES
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.protocols import Listener
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.rollout.threads import single_threaded
from tests.toy import CORRIDOR, PLAN

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


def uninterrupted(factory: pytest.TempPathFactory) -> Path:
    """A run that nothing interrupted, made once for all files that read it."""
    directory = factory.getbasetemp() / "whole-corridor"
    if not directory.exists():
        learn(directory)
    return directory
