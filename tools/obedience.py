"""How soon the robot does as a person says, with the page, its clients and busy cores."""

import random
import subprocess
import sys
import threading
import time
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from sheath_manip.cockpit import Cockpit, Order, beside_the_policy
from sheath_manip.cockpit.gate import PersonGate
from sheath_manip.cockpit.shown import NOTHING, Shown
from sheath_manip.dashboard import Dashboard
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.grasp_clutter.entry import drive_of, hold, teleop
from sheath_manip.tasks.grasp_clutter.task import GraspTask, Scenario
from sheath_manip.types import GateDecision, Observation, Proposal, Reason, Step
from tools.bench import Line, at_most
from tools.page_bench import (
    RATE_HZ,
    READERS,
    STALLED,
    EnoughError,
    Sizes,
    Taking,
    run_until_enough,
)
from tools.page_client import page_clients
from tools.scripted_person import Absent
from tools.station import Station


@dataclass
class Watched:
    """A gate that notes when each decision began and what it was."""

    gate: PersonGate
    began: list[tuple[float, Reason]] = field(default_factory=list)

    def reset(self, rng: np.random.Generator) -> None:
        """A new episode."""
        self.gate.reset(rng)

    def decide(self, observation: Observation, proposal: Proposal | None) -> GateDecision:
        """As the gate."""
        began_s = time.perf_counter()
        decision = self.gate.decide(observation, proposal)
        self.began.append((began_s, decision.reason))
        return decision

    def steps_until(
        self, reasons: Collection[Reason], since_s: float, timeout_s: float = 60.0
    ) -> int:
        """How many decisions began after `since_s` until one for these reasons, it included."""
        deadline_s = time.perf_counter() + timeout_s
        while time.perf_counter() < deadline_s:
            after = [found in reasons for began_s, found in list(self.began) if began_s > since_s]
            if any(after):
                return after.index(True) + 1
            time.sleep(0.002)
        raise TimeoutError(f"no step for {[*reasons]} in {timeout_s:g} s")


class HeardCockpit(Cockpit):
    """Notes when it heard each order."""

    def __init__(self, *args, **options) -> None:
        super().__init__(*args, **options)
        self.heard_s: dict[Order, float] = {}

    def order(
        self,
        order: Order,
        station: str | None,
        value: float = 1.0,
        shown: Shown = NOTHING,
    ) -> bool:
        """Note it, once it was followed."""
        done = super().order(order, station, value, shown)
        self.heard_s[order] = time.perf_counter()
        return done


@contextmanager
def burners(count: int) -> Iterator[None]:
    """So many processes that compute without end."""
    code = "while True: pass"
    processes = [subprocess.Popen((sys.executable, "-c", code)) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


def obedience(sizes: Sizes) -> dict[str, Line]:
    """Steps from hearing an order to acting on it, with the page, three clients and busy cores."""
    inner = ComposerEnvironment(GraspTask(Scenario(cameras=(), time_limit_s=3600.0)))
    by_hand = teleop(inner)
    cockpit = HeardCockpit(by_hand.guide)
    standing = hold(inner)
    gate = Watched(PersonGate(AlwaysPolicy(), cockpit, RATE_HZ))
    enough = threading.Event()

    class Until(Taking):
        def on_step(self, environment, step: Step) -> None:
            self.page.on_step(environment, step)
            if enough.is_set():
                raise EnoughError

    with (
        Dashboard(inner.spec, port=0, cockpit=cockpit) as page,
        page_clients(page.address, READERS, STALLED),
        burners(2),
        Station(page.address) as station,
    ):
        found: dict[Order, list[int]] = {Order.TAKE_OVER: [], Order.STOP: []}
        failed: list[BaseException] = []

        def person() -> None:
            try:
                play(station, cockpit, gate, sizes.trials, found)
            except BaseException as error:
                failed.append(error)
            finally:
                enough.set()
                cockpit.resume()

        thread = threading.Thread(target=person, daemon=True)
        thread.start()
        run_until_enough(
            inner,
            gate,
            (Until(page, 1, 1), Pacing()),
            policy=Absent(drive_of(inner).rest),
            others=beside_the_policy(cockpit, by_hand, hold=standing, fallback=standing),
        )
        thread.join()
    inner.close()
    if failed:
        raise failed[0]
    how = f"worst of {sizes.trials} by the page's websocket, 3 clients, 2 busy processes"
    return {
        "taking over acts within": at_most(max(found[Order.TAKE_OVER]), 1, "control steps", how),
        "the emergency stop acts within": at_most(max(found[Order.STOP]), 1, "control steps", how),
    }


def play(
    station: Station,
    cockpit: HeardCockpit,
    gate: Watched,
    trials: int,
    found: dict[Order, list[int]],
) -> None:
    """Take over, stop, reset, go on and hand back, again and again, at any moment of a step."""
    rng = random.Random(0)
    acts = {
        # The policy is out of it; what the person holds comes with the next heartbeat.
        Order.TAKE_OVER: (Reason.PERSON, Reason.IDLE),
        Order.STOP: (Reason.EMERGENCY_STOP,),
    }
    for _ in range(trials):
        station.hold(keys=["KeyI"] if rng.random() < 0.5 else ["KeyK"])
        for order in (Order.TAKE_OVER, Order.STOP):
            time.sleep(rng.uniform(0.0, 0.15))
            cockpit.heard_s.pop(order, None)
            station.order(order.value)
            while order not in cockpit.heard_s:
                time.sleep(0.001)
            found[order].append(gate.steps_until(acts[order], cockpit.heard_s[order]))
        # A reset counts only for a stop that was seen.
        station.until(lambda shown: shown["stopped"])
        station.order(Order.RESET.value)
        station.until(lambda shown: not shown["stopped"])
        station.order(Order.RESUME.value)
        station.order(Order.HAND_BACK.value)
        station.until(lambda shown: not shown["mine"] and not shown["paused"])
