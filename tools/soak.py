"""Run robot, page and recorder for a long time; see whether memory grows or an episode breaks.

    python -m tools.soak [--minutes 30] [--task driving] [--store DIRECTORY]

The expert drives episode after episode at a multiple of its pace, each is recorded, two clients
take all that the page sends and one has stalled, and a program at the page's websocket takes over
and hands back. Prints the memory as it goes, and exits with 1 where it grew by more than 5 % after
the warm-up, or where an episode is damaged.
"""

import argparse
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sheath_manip.cockpit import Cockpit, OperatedEnvironment, PersonGate, beside_the_policy
from sheath_manip.dashboard import Dashboard
from sheath_manip.dataset.check import check
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.rollout.action_noise import DisturbedExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import EpisodeInfo, Purpose
from tools.page_client import page_clients
from tools.station import Station

GROWTH = 0.05
WARM_UP = 0.3
"""of the time: caches fill, and the allocator finds its size"""
PAGE_BYTES = 4096


@dataclass
class Memory:
    """Resident memory of this process, sampled on a thread of its own."""

    every_s: float
    samples: list[tuple[float, float]] = field(default_factory=list)
    """seconds since the start, megabytes"""

    def watch(self, enough: threading.Event) -> None:
        """Sample until there is enough."""
        began_s, ended = time.monotonic(), False
        while not ended:
            self.samples.append((time.monotonic() - began_s, resident_mb()))
            print(f"{self.samples[-1][0]:7.0f} s {self.samples[-1][1]:8.1f} MB", flush=True)
            ended = enough.wait(self.every_s)

    def growth(self) -> float:
        """Of the last third's median over that of the first third after the warm-up."""
        warm = [mb for at_s, mb in self.samples if at_s >= WARM_UP * self.samples[-1][0]]
        third = max(len(warm) // 3, 1)
        return float(np.median(warm[-third:]) / np.median(warm[:third]) - 1)


def resident_mb() -> float:
    """Of this process."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE_BYTES / 1e6


def come_and_go(address: str, enough: threading.Event) -> None:
    """Take over and hand back, now and then; each time from a page of its own."""
    while not enough.wait(5.0):
        with Station(address) as station:
            station.order("take-over")
            station.hold(keys=["KeyJ"])
            enough.wait(1.0)
            station.order("hand-back")
            enough.wait(1.0)


def soak(task_name: str, minutes: float, directory: Path, speed: float) -> tuple[Memory, int]:
    """Run it; return the memory and how many episodes were recorded."""
    task = TASKS[task_name]
    inner = task.make()
    assert task.teleop is not None
    by_hand, scripted = task.teleop(inner), task.expert(inner)
    can_hold = "hold" in task.fallbacks
    standing = task.make_expert(inner, "hold") if can_hold else scripted
    cockpit = Cockpit(by_hand.guide, paced=True)
    store = EpisodeStore.create(directory)
    enough = threading.Event()
    memory = Memory(every_s=max(60 * minutes / 120, 0.5))
    with (
        Dashboard(inner.spec, port=0, cockpit=cockpit) as page,
        page_clients(page.address, readers=2, stalled=1),
    ):
        threads = [
            threading.Thread(target=memory.watch, args=(enough,), daemon=True),
            threading.Thread(target=come_and_go, args=(page.address, enough), daemon=True),
        ]
        for thread in threads:
            thread.start()
        count, ends_s = 0, time.monotonic() + 60 * minutes
        while time.monotonic() < ends_s:
            spec = inner.spec
            info = EpisodeInfo(
                spec.name, count, Purpose.LEARNING, spec.control_rate_hz, "soak", index=count
            )
            rollout(
                OperatedEnvironment(inner, cockpit),
                info,
                PersonGate(
                    AlwaysPolicy(),
                    cockpit,
                    spec.control_rate_hz,
                    wait_s=0.5,
                    can_hold=can_hold,
                    dead_man=by_hand.dead_man,
                ),
                rng=np.random.default_rng(count),
                policy=DisturbedExpert(scripted, spec.action, noise=0.0),
                others=beside_the_policy(cockpit, by_hand, hold=standing, fallback=scripted),
                listeners=(Recorder(store), page, Pacing(speed)),
            )
            count += 1
        enough.set()
        for thread in threads:
            thread.join(60.0)
    inner.close()
    return memory, count


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--minutes", type=float, default=30.0)
    parser.add_argument("--task", choices=sorted(TASKS), default="driving")
    parser.add_argument("--speed", type=float, default=2.0, help="times the task's own pace")
    parser.add_argument("--store", type=Path, help="to record into; a temporary one by default")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as folder:
        directory = options.store or Path(folder) / "store"
        memory, count = soak(options.task, options.minutes, directory, options.speed)
        faults = check(EpisodeStore(directory))
    growth = memory.growth()
    print(
        f"{count} episodes, {len(faults)} faults; memory {memory.samples[-1][1]:.0f} MB, "
        f"{growth:+.1%} after the warm-up (at most {GROWTH:+.0%})"
    )
    return int(bool(faults) or growth > GROWTH)


if __name__ == "__main__":
    sys.exit(main())
