"""Anything of the page is killed or hangs while a person drives: the robot holds in time.

The loop that moves the robot and the page are one process, so what can be killed beside it is the
browser, and what can hang is the page's thread or the one that draws.
"""

import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, Order, PersonGate, beside_the_policy
from sheath_manip.cockpit.standing import Ending
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.operator_socket import PATH
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.types import Actor, EpisodeInfo, Purpose, Step
from tests.cases import first_of
from tests.cockpit.operated_corridor import STRAIGHT
from tests.stopwatch import Stopwatch
from tests.toy import Corridor, hold, teleop
from tests.waiting import DEADLINE_S, eventually
from tools.station import admission

PROMISED_S = 0.5
HANGS_S = 2.0
KINDS = ("killed", "stopped", "page's thread hangs")
SEEDS = first_of(1, range(25))
pytestmark = pytest.mark.usefixtures("wide_corridor")


@dataclass
class Loop:
    """A run in a thread of its own, at the task's pace, and what it did."""

    page: Dashboard
    cockpit: Cockpit
    turns: list[Actor] = field(default_factory=list)

    def on_fit(self, states) -> None:
        del states

    def on_start(self, environment, info) -> None:
        del environment, info

    def on_step(self, environment, step: Step) -> None:
        del environment
        self.turns.append(step.decision.actor)

    def on_end(self, episode) -> None:
        del episode

    @property
    def turn(self) -> Actor:
        return self.turns[-1]


@contextmanager
def running() -> Iterator[Loop]:
    environment = Corridor(steps=100_000)
    cockpit = Cockpit(teleop(environment).guide, paced=True)
    others = beside_the_policy(
        cockpit, teleop(environment), hold=hold(environment), fallback=hold(environment)
    )
    with Dashboard(environment.spec, port=0, cockpit=cockpit) as page:
        loop = Loop(page, cockpit)

        def run() -> None:
            rollout(
                OperatedEnvironment(environment, cockpit),
                EpisodeInfo("corridor", 0, Purpose.LEARNING, 50.0),
                PersonGate(AlwaysPolicy(), cockpit, 50.0),
                rng=np.random.default_rng(0),
                policy=STRAIGHT,
                others=others,
                listeners=(page, loop, Pacing()),
            )

        thread = threading.Thread(target=run, name="operated corridor", daemon=True)
        thread.start()
        try:
            assert eventually(lambda: bool(loop.turns))
            yield loop
        finally:
            cockpit.end(Ending.SAVE)
            thread.join(DEADLINE_S)
        assert not thread.is_alive()


@contextmanager
def person_at(page: Dashboard) -> Iterator[subprocess.Popen]:
    admitted, port = admission(page.address), str(page._server.access.port)
    script = Path(__file__).with_name("doomed_station.py")
    process = subprocess.Popen(
        (sys.executable, "-SE", script, port, admitted.path + PATH, admitted.cookie, "KeyJ"),
        stderr=subprocess.DEVNULL,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait(DEADLINE_S)


def strike(kind: str, loop: Loop, person: subprocess.Popen) -> None:
    server_loop = loop.page._server.viser._websock_server._background_event_loop
    assert server_loop is not None
    match kind:
        case "killed":
            person.kill()
        case "stopped":
            os.kill(person.pid, signal.SIGSTOP)
        case "page's thread hangs":
            server_loop.call_soon_threadsafe(time.sleep, HANGS_S)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("kind", KINDS)
def test_the_robot_holds_within_half_a_second(kind, seed):
    rng = random.Random(f"{kind} {seed}")
    with running() as loop, person_at(loop.page) as person:
        assert eventually(lambda: loop.turn is Actor.OPERATOR)
        time.sleep(rng.uniform(0.0, 0.3))
        watch = Stopwatch()
        strike(kind, loop, person)
        assert eventually(lambda: loop.turn is Actor.HOLD)
        assert watch.took_s < PROMISED_S
        held = len(loop.turns)
        # Neither the policy nor a fallback goes on by itself, nor what is still under way.
        time.sleep(0.4)
        assert set(loop.turns[held:]) == {Actor.HOLD}
        person.kill()
        assert eventually(lambda: loop.cockpit.state.abandoned)
        assert loop.turn is Actor.HOLD
        loop.cockpit.order(Order.HAND_BACK, "the test")
        assert eventually(lambda: loop.turn is Actor.POLICY)
