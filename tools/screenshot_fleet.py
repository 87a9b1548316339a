"""Take pictures of the page of several robots: as some ask, and as one of them is served.

    python -m tools.screenshot_fleet DIRECTORY [--task driving] [--robots 4]

The task's expert stands in for a policy, and the gate asks for a person from time to time, in each
scene at other times, so that no policy has to be trained for a picture.
"""

import argparse
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from playwright.sync_api import Page

from sheath_manip.cli.operated import Operating
from sheath_manip.dashboard import Dashboard
from sheath_manip.fleet.fleet import Fleet
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.gates import SupportGate
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.protocols import Environment, Expert
from sheath_manip.rollout.request import Crew, EpisodeRequest
from sheath_manip.task import Task
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import (
    EpisodeInfo,
    Judgement,
    Observation,
    Observations,
    Proposal,
    Purpose,
)
from tools.chromium import TIMEOUT_S, chromium_page, open_dashboard, wait_until

SIZES = {"wide": (1400, 900), "phone": (390, 844)}
START_S = 600.0
"""for all robots to start, on a busy machine"""
SETTLED_MS = 4000
"""for the 3-D scene to be drawn in software"""
DRIVEN_MS = 1500


@dataclass(frozen=True)
class Posing:
    """The expert in a policy's place, under a gate that asks in the last part of each period."""

    period_s: float = 4.0
    asked_s: float = 1.5

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Make both of `environment`."""
        expert = task.make_expert(environment)
        gate = SupportGate(_Clock(self.period_s, self.asked_s), 0.0)
        return Crew(gate, _AsPolicy(expert), task.make_expert(environment))


@dataclass(frozen=True)
class _Clock:
    period_s: float
    asked_s: float

    def judge(self, observation: Observation, proposal: Proposal, threshold: float) -> Judgement:
        """Judge by the time, and by what is seen only so that scenes differ."""
        del proposal, threshold
        shift_s = float(abs(observation.features).sum()) % 0.3
        left_s = self.period_s - self.asked_s - observation.time_s % self.period_s
        return Judgement(0.2 * left_s + shift_s)


class _AsPolicy(Memoryless):
    def __init__(self, expert: Expert) -> None:
        self.expert = expert

    def reset(self, rng: np.random.Generator) -> None:
        """Begin an episode."""
        del rng
        self.expert.reset()

    def predict(self, observations: Observations) -> Proposal:
        """Propose what the expert does; it looks at the physics."""
        images = {camera: seen[0] for camera, seen in observations.images.items()}
        return Proposal(self.expert.act(Observation(images, observations.features[0], 0.0))[None])


def picture(page: Page, out: Path, name: str) -> None:
    """Write a picture in each size."""
    for size, (width, height) in SIZES.items():
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_timeout(SETTLED_MS)
        path = out / f"fleet-{name}-{size}.png"
        page.screenshot(path=path, timeout=1000 * TIMEOUT_S)
        print(path, flush=True)
    page.set_viewport_size(dict(zip(("width", "height"), SIZES["wide"], strict=True)))  # pyright: ignore[reportArgumentType]


def photographed(page: Page, task: Task, robots: int, out: Path) -> None:
    """Run the robots and take the pictures."""
    post = Operating().post(task, float("inf"))
    infos = [
        EpisodeInfo.of(
            post.spec,
            variant="default",
            seed=index,
            purpose=Purpose.LEARNING,
            method="sheath",
            index=index,
        )
        for index in range(robots)
    ]
    requests = [EpisodeRequest(task, info, Posing()) for info in infos]
    cockpit = FleetCockpit(robots, post.guide, post.fallback_shown, post.planar)
    with (
        Dashboard(post.spec, port=0, cockpit=cockpit, pictures=cockpit.roster.pictures) as shown,
        Fleet(post, cockpit, shown.count) as fleet,
    ):
        cockpit.on_film = shown.show
        threading.Thread(target=lambda: list(fleet.run(requests)), daemon=True).start()

        def all_are(*does: str) -> bool:
            return all(each.does in does for each in cockpit.state.robots)

        wait_until(lambda: all_are("held"), "robots", page, START_S)
        open_dashboard(page, shown.address)
        page.wait_for_selector("canvas")
        notice = page.get_by_role("alert").get_by_role("button")
        if notice.count():
            notice.first.click()
        picture(page, out, "ready")
        page.keyboard.press("h")
        wait_until(lambda: len(cockpit.roster.queue()) >= 2, "requests", page, START_S)
        picture(page, out, "asking")
        page.keyboard.press("t")
        page.keyboard.down(post.guide[0].codes[0])
        page.wait_for_timeout(DRIVEN_MS)
        cockpit.pause()
        picture(page, out, "served")
        page.keyboard.press("Space")
        picture(page, out, "stopped")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, help="directory for the PNGs")
    parser.add_argument("--task", choices=sorted(TASKS), default="driving")
    parser.add_argument("--robots", type=int, default=4)
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    with chromium_page() as page:
        photographed(page, TASKS[options.task], options.robots, options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
