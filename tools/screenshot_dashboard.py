"""Take a picture of every tab of the live page and of the replay page, for each task.

    python -m tools.screenshot_dashboard DIRECTORY [--tasks driving platformer] [--expert]
        [--checkpoint FILE --store DIRECTORY] [--moments STORE ...]

A policy drives under its gate until the expert has taken over; there the run is held, and headless
Chromium takes the pictures; the same episode, recorded, is what the replay page shows. Then a
person is the expert: the page as the robot asks for one, and as one drives. Without a checkpoint
one is trained first by the task's plan `quick`, in a minute or more; with --expert there is no
policy, and the expert is seen. With --moments there is one picture alone: the wall of the moments
of those stores, on a desk; and of it in a small window and on a phone.
"""

import argparse
import io
import sys
import tempfile
import threading
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from itertools import count
from pathlib import Path

from playwright.sync_api import Page
from rich.console import Console

from sheath_manip.cli.episodes import run_all
from sheath_manip.cli.operated import Operating
from sheath_manip.cli.options import Address
from sheath_manip.cli.session import Catalog, Session
from sheath_manip.cockpit import Cockpit
from sheath_manip.cockpit.cockpit import Ending
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.protocols import Environment
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.rollout.workplace import Workplace
from sheath_manip.task import Task
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Actor, Episode, EpisodeInfo, Step
from sheath_manip.types.samples import Samples
from tools.chromium import chromium_page, open_dashboard, take_picture, wait_until
from tools.replayed_page import replayed
from tools.screenshot_subject import Subject, subject_of

MIN_STEPS, MIN_INTERVENTIONS, MIN_TURN_STEPS = 60, 2, 4
"""of the episode in the picture, and of the intervention under way: enough to be seen"""
LIVE_TABS = ("Run", "Why", "What if", "Learning")
REPLAY_TABS = ("Episode", "Episodes", "Why", "What if", "Marks")
WALL_SIZES = {
    "moments-phone": (390, 844),
    "moments-small": (1024, 768),
    "moments": (1400, 900),
}
POSE_TIMEOUT_S = 1800.0
"""training included"""
SETTLED_MS = 2500
"""for the 3-D scene to be drawn in software"""
DRIVEN_MS, PAUSED_MS = 700, 300
"""by a held key, before the picture of a person who drives; and for a run to be paused"""


class Pose:
    """A listener that holds the run at the first step worth a picture."""

    def __init__(self, with_policy: bool) -> None:
        self.struck = threading.Event()
        self.taken = threading.Event()
        self._with_policy = with_policy
        self._steps = self._interventions = self._turn_steps = 0

    def on_fit(self, states: Samples) -> None:
        """Nothing to see yet."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Count anew."""
        del environment, info
        self._steps = self._interventions = self._turn_steps = 0

    def on_step(self, environment: Environment, step: Step) -> None:
        """Wait for the picture where the expert has taken over."""
        del environment
        self._steps += 1
        self._turn_steps = self._turn_steps + 1 if step.decision.actor is Actor.EXPERT else 0
        self._interventions += self._turn_steps == 1
        wanted = MIN_INTERVENTIONS if self._with_policy else 1
        if (
            self._steps >= MIN_STEPS
            and self._interventions >= wanted
            and self._turn_steps >= MIN_TURN_STEPS
            and not self.taken.is_set()
        ):
            self.struck.set()
            self.taken.wait()

    def on_end(self, episode: Episode) -> None:
        """The next one, then."""


def photograph(page: Page, tabs: Sequence[str], name: str, out: Path) -> None:
    """Write a picture of each of the `tabs` that the page has."""
    page.wait_for_selector("canvas")
    # A notice that only a browser without a graphics card gives.
    notice = page.get_by_role("alert").get_by_role("button")
    if notice.count():
        notice.first.click()
    for tab in tabs:
        page.get_by_role("tab", name=tab, exact=True).click()
        page.wait_for_timeout(SETTLED_MS)
        take_picture(page, out / f"{name}-{tab.lower().replace(' ', '-')}.png")


def live(page: Page, task: Task, options: argparse.Namespace, folder: Path) -> Subject:
    """The live page, at an intervention; the episode goes on into the store `folder`/recorded."""
    pose = Pose(with_policy=not options.expert)
    shown: Future[Dashboard] = Future()

    def drive() -> Subject:
        # All in one thread, because a GL context belongs to the one that made it.
        with Workplace() as workplace:
            spec = workplace.environment(task, "default", 0).spec
            subject = subject_of(task, options, spec, folder)
            adjusting = subject.adjusting
            widgets = () if adjusting is None else adjusting.widgets
            explainer = None if adjusting is None else adjusting.explainer
            with Dashboard(spec, port=0, gate=widgets, explainer=explainer) as dashboard:
                shown.set_result(dashboard)
                if adjusting is not None and adjusting.states is not None:
                    dashboard.on_fit(adjusting.states)
                recorder = Recorder(EpisodeStore.create(folder / "recorded"))
                listeners = (dashboard, recorder, pose, Pacing(4.0))
                method = "expert" if adjusting is None else "sheath"
                for index in count(options.scene):
                    if pose.taken.is_set():
                        break
                    workplace.run(subject.request(subject.driver, method, index), listeners)
            return subject

    with ThreadPoolExecutor(1) as pool:
        run = pool.submit(drive)
        try:
            wait_until(lambda: shown.done() or run.done(), "page", page, POSE_TIMEOUT_S)
            if run.done():
                run.result()
            open_dashboard(page, shown.result().address)
            wait_until(
                lambda: pose.struck.is_set() or run.done(), "intervention", page, POSE_TIMEOUT_S
            )
            # Nobody has paused it, but it has the page draw the images that it has skipped.
            shown.result().resume()
            photograph(page, LIVE_TABS, task.name, options.out)
        finally:
            pose.taken.set()
        return run.result()


def operated(page: Page, subject: Subject, options: argparse.Namespace) -> None:
    """The page of a run whose expert is a person: as the robot asks, and as a person drives."""
    task, adjusting = subject.task, subject.adjusting
    if task.teleop is None or adjusting is None:
        return
    operating = Operating(wait_s=60.0)
    shown: Future[Cockpit] = Future()
    addresses: list[str] = []
    session = Session(lambda: Catalog({}, {}), "", *(Console(file=io.StringIO()) for _ in range(2)))

    def drive() -> None:
        with (
            operating.crew(
                task, Address(port=0), session, adjusting.widgets, adjusting.explainer
            ) as crew,
            SerialExecutor() as executor,
        ):
            addresses.append(crew.page.address)
            shown.set_result(crew.cockpit)
            if adjusting.states is not None:
                crew.page.on_fit(adjusting.states)
            by_hand, driver = replace(subject, task=crew.operated()), crew.driver(adjusting.driver)
            requests = (by_hand.request(driver, "person", at) for at in count(options.scene))
            for _ in run_all(executor, requests, listeners=crew.listeners):
                if crew.cockpit.closed:
                    break

    def hold(turn: Actor) -> bool:
        """Hold the run in such a turn, so that it is still so in the picture."""
        if cockpit.turn is not turn:
            return False
        cockpit.pause()
        # One more step may have begun, and have become somebody else's.
        page.wait_for_timeout(PAUSED_MS)
        if cockpit.turn is not turn:
            cockpit.resume()
        return cockpit.turn is turn

    with ThreadPoolExecutor(1) as pool:
        run = pool.submit(drive)
        cockpit = shown.result()
        try:
            open_dashboard(page, addresses[0])
            wait_until(lambda: hold(Actor.HOLD), "request for a person", page)
            photograph(page, ("Run",), f"{task.name}-asking", options.out)
            cockpit.resume()
            page.keyboard.press("t")
            page.keyboard.down(cockpit.guide[0].codes[0])
            page.wait_for_timeout(DRIVEN_MS)
            wait_until(lambda: hold(Actor.OPERATOR), "person", page)
            photograph(page, ("Run", "Why"), f"{task.name}-person", options.out)
        finally:
            cockpit.end(Ending.SAVE)
            cockpit.close()
        run.result()


def recorded(page: Page, subject: Subject, options: argparse.Namespace, folder: Path) -> None:
    """The replay page, at the middle of the last intervention."""
    task, adjusting = subject.task, subject.adjusting
    explainer = None if adjusting is None else adjusting.explainer
    fitted = None if subject.checkpoint is None else subject.checkpoint.fitted
    catalog = EpisodeCatalog(EpisodeStore(folder / "recorded"))
    with replayed(page, task, catalog, explainer, fitted) as replay:
        film = replay.player.now.film
        assert film is not None
        turns = film.trace.so_far().turns or [(0, len(film))]
        replay.player.look_at(sum(turns[-1]) // 2)
        photograph(page, REPLAY_TABS, f"{task.name}-replay", options.out)


def moments(page: Page, stores: Sequence[Path], out: Path) -> None:
    """The wall of the moments of all `stores`, which are of one of the tasks here."""
    catalog = EpisodeCatalog(*map(EpisodeStore, stores))
    with replayed(page, TASKS[catalog.summary(0).info.task], catalog):
        page.wait_for_function("window.sheathSeek?.open && window.sheathWall")
        page.keyboard.press("o")
        page.locator("#sheath-wall .tile img").first.wait_for()
        for name, (width, height) in WALL_SIZES.items():
            page.set_viewport_size({"width": width, "height": height})
            page.wait_for_timeout(SETTLED_MS)
            take_picture(page, out / f"{name}.png")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, help="directory for the PNGs")
    parser.add_argument("--tasks", nargs="+", choices=sorted(TASKS), default=sorted(TASKS))
    parser.add_argument("--expert", action="store_true", help="watch the expert, without a policy")
    parser.add_argument("--checkpoint", type=Path, help="of the policy and its gate, for one task")
    parser.add_argument("--store", type=Path, help="of the episodes that it was fitted to")
    parser.add_argument("--moments", type=Path, nargs="+", help="stores for the wall alone")
    parser.add_argument("--scene", type=int, default=0, help="to begin with, from 0")
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    if options.moments:
        with chromium_page() as page:
            moments(page, options.moments, options.out)
        return 0
    for name in options.tasks:
        with (
            tempfile.TemporaryDirectory() as folder,
            single_threaded(),
            chromium_page() as page,
        ):
            subject = live(page, TASKS[name], options, Path(folder))
            recorded(page, subject, options, Path(folder))
            operated(page, subject, options)
    return 0


if __name__ == "__main__":
    sys.exit(main())
