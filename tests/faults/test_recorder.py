"""A recorder is no onlooker: where it fails the run ends, with the robot held."""

from typing import Any

import numpy as np
import pytest

from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import AttemptError, StoreError
from sheath_manip.gates import AlwaysExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.types import Actor, Breakdown, EpisodeInfo, Outcome, Purpose
from tests.faults.parts import Faulty, Onlooker
from tests.faults.ways import RAISING, Way, raising
from tests.toy import Corridor, MiddleKeeper, hold


def run(store: EpisodeStore, method: str, way: Way) -> Onlooker:
    """Record an episode, while `method` of the recorder goes the `way` the fourth time."""
    environment, onlooker = Corridor(), Onlooker()
    calls = 3 if method == "on_step" else 0
    recorder: Any = Faulty(Recorder(store), method, way, calls, 9)
    try:
        rollout(
            environment,
            EpisodeInfo("corridor", 4, Purpose.LEARNING, 50.0),
            AlwaysExpert(),
            rng=np.random.default_rng(0),
            expert=MiddleKeeper(environment),
            hold=hold(environment),
            listeners=(recorder, onlooker),
        )
    finally:
        assert onlooker.heard.count("end") == (0 if method == "on_start" else 1)
    return onlooker


@pytest.mark.parametrize("way", [RAISING["TypeError"], RAISING["MemoryError"]])
def test_one_that_fails_in_a_step_has_the_attempt_so_far(tmp_path, way):
    store = EpisodeStore.create(tmp_path / "store")
    with pytest.raises(AttemptError, match="the recorder broke down"):
        run(store, "on_step", way)
    (name,) = store.names()
    episode = store.read(name)
    assert episode.outcome is Outcome.ERROR
    assert episode.cut_short_by is not None
    assert episode.cut_short_by.who == "recorder"
    assert episode.steps[-1].decision.actor in (Actor.HOLD, Actor.EXPERT)


def test_one_that_cannot_write_is_told_in_its_own_words(tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    with pytest.raises(StoreError, match="the disk is full"):
        run(store, "on_end", raising(lambda: StoreError("the disk is full")))
    with pytest.raises(AttemptError, match=r"TypeError.*the episode is not recorded"):
        run(store, "on_end", RAISING["TypeError"])
    assert store.names() == []


def test_one_that_cannot_begin_ends_the_run_before_it_moves(tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    with pytest.raises(AttemptError, match="nothing of it is recorded"):
        run(store, "on_start", RAISING["OSError"])


def test_what_broke_down_comes_back_from_the_store_in_its_order(tmp_path):
    store = EpisodeStore.create(tmp_path / "store")
    environment = Corridor()
    expert: Any = Faulty(MiddleKeeper(environment), "act", RAISING["KeyError"], 5, 1)
    with pytest.raises(AttemptError):
        rollout(
            environment,
            EpisodeInfo("corridor", 4, Purpose.LEARNING, 50.0),
            AlwaysExpert(),
            rng=np.random.default_rng(0),
            expert=expert,
            hold=hold(environment),
            listeners=(Recorder(store),),
        )
    (name,) = store.names()
    read, broken = store.read(name), Breakdown("expert", "KeyError")
    assert [step.decision.broken for step in read.steps][:6] == [()] * 5 + [(broken,)]
    assert read.cut_short_by == broken
    assert [step.decision.actor for step in read.steps[5:]] == [Actor.HOLD] * (len(read) - 5)
    assert len(read) > 6
