"""Take pictures of the page of several robots: some ask, one is served, all are stopped.

    python -m tools.screenshot_fleet DIRECTORY [--task driving]

The robots are not run but played: each is the beginning of a real episode of the task, driven by
its expert in a policy's place, and told to the page as a robot's process tells it. So a picture
costs a few seconds of one core, and is the same again.
"""

import argparse
import sys
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from playwright.sync_api import Page

from sheath_manip.cli.operated import Operating
from sheath_manip.cockpit import Cockpit, OperatedEnvironment
from sheath_manip.cockpit.post import Post
from sheath_manip.cockpit.question import Question
from sheath_manip.cockpit.standing import Ending
from sheath_manip.cockpit.state import State
from sheath_manip.dashboard import Dashboard
from sheath_manip.fleet.fleet_cockpit import FleetCockpit
from sheath_manip.fleet.from_robot import Asked, Begun, FromRobot, Report, Stepped
from sheath_manip.fleet.outbox import Outbox
from sheath_manip.fleet.seat import Seat
from sheath_manip.gates import AlwaysPolicy
from sheath_manip.playback.film import film_begun, pose_of
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.protocols import Environment, Expert
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import (
    Actor,
    Episode,
    EpisodeInfo,
    GateDecision,
    Observation,
    Observations,
    Proposal,
    Purpose,
    Reason,
    Step,
)
from sheath_manip.types.samples import Samples
from tools.chromium import TIMEOUT_S, chromium_page, open_dashboard, wait_until

SIZES = {"wide": (1400, 900), "phone": (390, 844)}
SETTLED_MS = 6000
"""for the 3-D scene to be drawn in software"""
STEPS = (70, 55, 64, 40)
"""of each robot's episode so far"""
BELOW = {2: 0.3, 3: 0.7}
"""by how much the score of those that ask is below the threshold"""
THRESHOLD = 0.2


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


@dataclass
class _Taking:
    """A listener that keeps what a robot's process would tell, and ends the episode in time."""

    number: int
    cockpit: Cockpit
    told: list[FromRobot] = field(default_factory=list)

    def on_fit(self, states: Samples) -> None:
        """Nothing to tell."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Tell of the scene."""
        film = film_begun(environment, info)
        self.told.append(Begun(info, film.scene, film.first_pose, film.lacks))

    def on_step(self, environment: Environment, step: Step) -> None:
        """Tell of the step, whose score falls towards a request."""
        made, steps = len(self.told), STEPS[self.number - 1]
        falls = BELOW.get(self.number, -0.3) * (made / steps) ** 3
        score = THRESHOLD + 0.3 - 0.3 * (made / steps) ** 3 - falls + 0.05 * np.sin(made)
        decision = GateDecision(Actor.POLICY, False, Reason.INSIDE, max(score, 0.21), THRESHOLD)
        self.told.append(Stepped(replace(step, decision=decision), pose_of(environment)))
        if made + 1 >= steps:
            self.cockpit.end(Ending.SAVE)

    def on_end(self, episode: Episode) -> None:
        """Tell what it asks, if anything."""
        if self.number in BELOW:
            score = THRESHOLD - BELOW[self.number]
            wanted = GateDecision(Actor.EXPERT, True, Reason.OUTSIDE, score, THRESHOLD)
            last = episode.steps[-1]
            self.told.append(Asked(Question(last.observation, last.proposed, wanted)))


def played(post: Post, number: int) -> list[FromRobot]:
    """Return what the process of that robot would have told."""
    cockpit, environment = Cockpit(post.guide), post.task.make()
    taking = _Taking(number, cockpit)
    info = EpisodeInfo.of(
        post.spec,
        variant="default",
        seed=number,
        purpose=Purpose.LEARNING,
        method="sheath-person",
        index=number - 1,
    )
    rollout(
        OperatedEnvironment(environment, cockpit),
        info,
        AlwaysPolicy(),
        rng=np.random.default_rng(0),
        policy=_AsPolicy(post.task.make_expert(environment)),
        listeners=(taking,),
    )
    environment.close()
    return taking.told


class _Nobody(Outbox):
    def __init__(self) -> None:
        """Send nothing to nobody."""

    def put(self, message: object) -> None:
        """Drop it."""


def state_of(seat: Seat, cockpit: FleetCockpit) -> State:
    """Return how the robot of a seat stands."""
    own = State(operated=True, stopped=cockpit.lease.holder is None and bool(cockpit.state.stops))
    taken = seat is cockpit.roster.shown and cockpit.lease.holder is not None
    if taken:
        return replace(own, taken=True, turn=Actor.OPERATOR, may_go_on=False)
    if seat.question is None or own.stopped:
        return own
    return replace(own, turn=Actor.HOLD, asking=True, may_go_on=False, left_s=float("inf"))


def photographed(page: Page, post: Post, out: Path) -> None:
    """Play the robots and take the pictures."""
    cockpit = FleetCockpit(len(STEPS), post.guide, post.fallback_shown, post.planar)
    over = threading.Event()

    def report() -> None:
        while not over.wait(0.1):
            for seat in cockpit.roster.seats:
                state = state_of(seat, cockpit)
                cockpit.hear(seat, Report(time.monotonic(), state, state.asking, None))

    with Dashboard(post.spec, port=0, cockpit=cockpit, pictures=cockpit.roster.pictures) as shown:
        cockpit.on_film = shown.show
        for seat in cockpit.roster.seats:
            cockpit.attach(seat, _Nobody())
            for message in played(post, seat.number):
                cockpit.hear(seat, message)
        threading.Thread(target=report, daemon=True).start()
        open_dashboard(page, shown.address)
        page.wait_for_selector("canvas")
        page.wait_for_timeout(SETTLED_MS)
        notice = page.get_by_role("alert").get_by_role("button")
        if notice.count():
            notice.first.click()
        picture(page, out, "asking")
        page.keyboard.press("t")
        page.keyboard.down(post.guide[0].codes[0])
        wait_until(lambda: cockpit.lease.holder is not None, "person", page)
        picture(page, out, "served")
        page.keyboard.press("Space")
        picture(page, out, "stopped")
        over.set()


def picture(page: Page, out: Path, name: str) -> None:
    """Write a picture in each size."""
    for size, (width, height) in SIZES.items():
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_timeout(SETTLED_MS)
        path = out / f"fleet-{name}-{size}.png"
        page.screenshot(path=path, timeout=1000 * TIMEOUT_S)
        print(path, flush=True)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, help="directory for the PNGs")
    parser.add_argument("--task", choices=sorted(TASKS), default="driving")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    post = Operating().post(TASKS[options.task], float("inf"))
    with chromium_page() as page:
        photographed(page, post, options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
