"""Measure what the page costs the robot, and how soon the robot does as a person says.

    python -m tools.bench_dashboard [--quick]

Writes results/bench-dashboard.json, which `sheath claims` judges. The page's clients are processes
of their own: two that take everything, one that has stalled; and so is the wall of moments of a
replay.
"""

import time
from collections.abc import Callable, Sequence

import numpy as np

from sheath_manip.dashboard import Dashboard
from sheath_manip.gates import AlwaysExpert
from sheath_manip.protocols import Expert, Listener
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.task import DrivingTask
from sheath_manip.tasks.driving.task import Scenario as DrivingScenario
from sheath_manip.tasks.grasp_clutter.entry import hold
from sheath_manip.tasks.grasp_clutter.task import GraspTask
from sheath_manip.tasks.grasp_clutter.task import Scenario as GraspScenario
from sheath_manip.types import EpisodeInfo, Purpose, Step
from tools.bench import Line, at_most, run_bench
from tools.obedience import obedience
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
from tools.wall_reader import BesideWall, open_wall


def loop_period(sizes: Sizes) -> dict[str, Line]:
    """The control loop's period without and with the page, in blocks that take turns."""
    with open_wall(sizes.wall_episodes) as wall:
        alone = _periods(sizes, lambda page: page)
        walled = _periods(sizes, lambda page: BesideWall(page, wall))
    return {
        "loop period, page to none": _unmoved(alone, "with 3 clients, 1 stalled"),
        "loop period, page and wall to none": _unmoved(
            walled,
            "with 3 clients and the wall",
            f"; a wall of {sizes.wall_episodes} episodes is open in a process of its own, and read "
            "in each step",
        ),
    }


def _periods(
    sizes: Sizes, followed_by: Callable[[Dashboard], Listener]
) -> tuple[np.ndarray, np.ndarray]:
    """Between steps, without and with what follows."""
    environment = ComposerEnvironment(GraspTask(GraspScenario(time_limit_s=3600.0)))
    with (
        Dashboard(environment.spec, port=0) as page,
        page_clients(page.address, READERS, STALLED),
    ):
        taking = Taking(followed_by(page), sizes.block, sizes.rounds)
        expert = hold(environment)
        run_until_enough(environment, AlwaysExpert(), (Pacing(), taking), expert=expert)
    environment.close()
    return taking.periods_s()


def _unmoved(periods_s: tuple[np.ndarray, np.ndarray], unit: str, more: str = "") -> Line:
    alone_s, watched_s = periods_s
    p99 = np.percentile(watched_s, 99) / np.percentile(alone_s, 99)
    how = (
        f"p99 of {len(watched_s)} periods each, {1e3 * np.percentile(alone_s, 99):.1f} ms alone; "
        f"medians {1e3 * np.median(alone_s):.1f} and {1e3 * np.median(watched_s):.1f} ms{more}"
    )
    return at_most(p99, 1.05, unit, how)


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


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    run_bench(
        "dashboard",
        __doc__,
        (loop_period, frame, obedience),
        Sizes(rounds=12, block=50, frames=240, trials=40, wall_episodes=10_000),
        Sizes(rounds=1, block=20, frames=20, trials=3, wall_episodes=500),
        arguments,
    )


if __name__ == "__main__":
    main()
