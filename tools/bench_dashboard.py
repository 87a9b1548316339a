"""Measure what the page costs the robot, and how soon the robot does as a person says.

    python -m tools.bench_dashboard [--quick]

Writes results/bench-dashboard.json, which `sheath claims` judges. The page's clients are processes
of their own: two that take everything, one that has stalled.
"""

import random
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np

from sheath_manip.cockpit import Cockpit, Order, beside_the_policy
from sheath_manip.cockpit.gate import PersonGate
from sheath_manip.dashboard import Dashboard
from sheath_manip.gates import AlwaysExpert, AlwaysPolicy
from sheath_manip.protocols import Environment, Expert, Gate, Listener, Policy
from sheath_manip.rollout.loop import NOBODY, rollout
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.task import DrivingTask
from sheath_manip.tasks.driving.task import Scenario as DrivingScenario
from sheath_manip.tasks.grasp_clutter.entry import drive_of, hold, teleop
from sheath_manip.tasks.grasp_clutter.task import GraspTask
from sheath_manip.tasks.grasp_clutter.task import Scenario as GraspScenario
from sheath_manip.types import (
    Actor,
    EpisodeInfo,
    GateDecision,
    Observation,
    Proposal,
    Purpose,
    Reason,
    Step,
)
from tools.bench import Line, at_most, run_bench
from tools.page_client import page_clients
from tools.scripted_person import Absent
from tools.station import Station

READERS, STALLED = 2, 1
RATE_HZ = 20.0


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    rounds: int
    """of blocks that take turns, without and with the page"""
    block: int
    """steps in each"""
    frames: int
    """drawn to see what one costs"""
    trials: int
    """of taking over, and of stopping"""


class EnoughError(Exception):
    """Ends a rollout that has shown what it was run for."""


@dataclass
class Taking:
    """A listener that has another one follow in turns, and notes when each step was done."""

    page: Listener
    block: int
    rounds: int
    done_s: list[float] = field(default_factory=list)

    def on_fit(self, states) -> None:
        """Nothing is measured of it."""

    def on_start(self, environment, info) -> None:
        """The page sees the scene."""
        self.page.on_start(environment, info)

    def on_step(self, environment, step: Step) -> None:
        """The page follows every second block."""
        if len(self.done_s) // self.block % 2:
            self.page.on_step(environment, step)
        self.done_s.append(time.perf_counter())
        if len(self.done_s) >= 2 * self.rounds * self.block:
            raise EnoughError

    def on_end(self, episode) -> None:
        """Nothing is measured of it."""

    def periods_s(self) -> tuple[np.ndarray, np.ndarray]:
        """Between steps, without and with the page; the first of each block is neither's."""
        periods = np.diff(np.array(self.done_s))
        at = np.arange(1, len(self.done_s))
        within, watched = at % self.block != 0, at // self.block % 2 == 1
        return periods[within & ~watched], periods[within & watched]


def run_until_enough(
    environment: Environment,
    gate: Gate,
    listeners: Sequence[Listener],
    *,
    policy: Policy | None = None,
    expert: Expert | None = None,
    others: Mapping[Actor, Expert] = NOBODY,
) -> None:
    """Episode after episode until a listener has seen enough."""
    spec = environment.spec
    try:
        for index in range(1_000_000):
            rollout(
                environment,
                EpisodeInfo(spec.name, index, Purpose.LEARNING, spec.control_rate_hz),
                gate,
                rng=np.random.default_rng(index),
                policy=policy,
                expert=expert,
                others=others,
                listeners=listeners,
            )
    except EnoughError:
        pass


def loop_period(sizes: Sizes) -> dict[str, Line]:
    """The control loop's period without and with the page, in blocks that take turns."""
    environment = ComposerEnvironment(GraspTask(GraspScenario(time_limit_s=3600.0)))
    with (
        Dashboard(environment.spec, port=0) as page,
        page_clients(page.address, READERS, STALLED),
    ):
        taking = Taking(page, sizes.block, sizes.rounds)
        expert = hold(environment)
        run_until_enough(environment, AlwaysExpert(), (Pacing(), taking), expert=expert)
    environment.close()
    alone_s, watched_s = taking.periods_s()
    p99 = np.percentile(watched_s, 99) / np.percentile(alone_s, 99)
    how = (
        f"p99 of {len(watched_s)} periods each, {1e3 * np.percentile(alone_s, 99):.1f} ms alone; "
        f"medians {1e3 * np.median(alone_s):.1f} and {1e3 * np.median(watched_s):.1f} ms"
    )
    return {"loop period, page to none": at_most(p99, 1.05, "with 3 clients, 1 stalled", how)}


def frame(sizes: Sizes) -> dict[str, Line]:
    """CPU time of the whole process for one frame at 20 Hz, over that of a loop without page."""
    grasp = ComposerEnvironment(GraspTask())
    driving = ComposerEnvironment(DrivingTask(DrivingScenario()))
    lines = {}
    for environment, expert in ((grasp, hold(grasp)), (driving, DrivingExpert(driving))):
        steps = seen(environment, expert, min(sizes.frames, 100))
        with (
            Dashboard(environment.spec, port=0) as page,
            page_clients(page.address, 1, 0),
        ):
            spec = environment.spec
            info = EpisodeInfo(spec.name, 0, Purpose.LEARNING, spec.control_rate_hz)
            page.on_start(environment, info)

            def drawn(step: Step, page=page, environment=environment) -> None:
                page.on_step(environment, step)

            for step in steps[:20]:
                drawn(step)
                time.sleep(1 / RATE_HZ)
            spent = [
                [cpu_s(each, steps, sizes.frames // 4) for each in (lambda _: None, drawn)]
                for _ in range(4)
            ]
        alone_s, watched_s = np.median(spent, axis=0)
        how = f"process CPU, {sizes.frames} frames at {RATE_HZ:g} Hz, 1 client"
        name = f"page's work a frame, {spec.name}"
        lines[name] = at_most(1e3 * (watched_s - alone_s), 5.0, "ms of CPU", how)
    grasp.close()
    driving.close()
    return lines


def seen(environment: ComposerEnvironment, expert: Expert, count: int) -> list[Step]:
    """So many steps of an episode."""
    steps: list[Step] = []

    class Notes(Taking):
        def on_start(self, environment, info) -> None:
            pass

        def on_step(self, environment, step: Step) -> None:
            del environment
            steps.append(step)
            if len(steps) >= count:
                raise EnoughError

    notes = Notes(None, 1, 1)  # pyright: ignore[reportArgumentType]
    run_until_enough(environment, AlwaysExpert(), (notes,), expert=expert)
    return steps


def cpu_s(each: Callable[[Step], None], steps: Sequence[Step], frames: int) -> float:
    """CPU seconds of this process, all threads, for a frame."""
    began_s = time.process_time()
    for number in range(frames):
        each(steps[number % len(steps)])
        time.sleep(1 / RATE_HZ)
    return (time.process_time() - began_s) / frames


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
        self, order: Order, station: str, value: float = 1.0, seen: int | None = None
    ) -> bool:
        """Note it, once it was followed."""
        done = super().order(order, station, value, seen)
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
    inner = ComposerEnvironment(GraspTask(GraspScenario(cameras=(), time_limit_s=3600.0)))
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


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    run_bench(
        "dashboard",
        __doc__,
        (loop_period, frame, obedience),
        Sizes(rounds=12, block=50, frames=240, trials=40),
        Sizes(rounds=1, block=20, frames=20, trials=3),
        arguments,
    )


if __name__ == "__main__":
    main()
