"""Film the page at work: a policy drives, the robot asks, a person drives; then one looks back.

    python -m tools.film_page FILE.mp4 [--checkpoint FILE --store DIRECTORY] [--learned TASK RUNS]

Without a checkpoint one is trained first by driving's plan `quick`. RUNS is the folder of an
experiment of TASK, whose learning curves the film ends with. Headless Chromium shows the
page; the person's hands are the scripted expert's, on the page's own keys. The film runs as the
clock did while it was taken, and leaves out what lay between.
"""

import argparse
import io
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
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
from sheath_manip.playback.film import Film, film_begun
from sheath_manip.playback.video import mp4
from sheath_manip.protocols import Environment
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.task import Task
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import Episode, EpisodeInfo, Step
from sheath_manip.types.samples import Samples
from sheath_manip.types.work import Work
from tools.chromium import chromium_page, drawn_width, open_dashboard, wait_until
from tools.fleet_person import Eyes
from tools.reel import RATE_HZ, Reel
from tools.replayed_page import replayed
from tools.screenshot_learning import info_of, results_of
from tools.screenshot_subject import Subject, subject_of
from tools.scripted_person import at_the_wheel

GROWN = 20
"""pictures of the curves as they grow"""
SPEED = 0.5
"""times the task's pace, since the software that draws is slow"""


class Now:
    """A listener that knows the present episode so far."""

    film: Film | None = None

    def on_fit(self, states: Samples) -> None:
        """Nothing to see yet."""

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Begin anew."""
        self.film = film_begun(environment, info)

    def on_step(self, environment: Environment, step: Step) -> None:
        """Take note of it."""
        del environment
        if self.film is not None:
            self.film.steps.append(step)

    def on_end(self, episode: Episode) -> None:
        """The next one, then."""
        del episode
        self.film = None


class Hands:
    """Hold on the keyboard what the expert would."""

    def __init__(self, page: Page, now: Now, eyes: Eyes) -> None:
        self.page, self.now, self.eyes = page, now, eyes
        self.held: frozenset[str] = frozenset()

    def drive(self) -> None:
        """Look, and hold it."""
        film = self.now.film
        self.hold(frozenset() if film is None else at_the_wheel(self.eyes.action(film)).keys)

    def hold(self, keys: frozenset[str]) -> None:
        """Hold these keys and no others."""
        for key in self.held - keys:
            self.page.keyboard.up(key)
        for key in keys - self.held:
            self.page.keyboard.down(key)
        self.held = keys


def settle(page: Page) -> None:
    """Wait for the scene, and put away the notice that only software drawing gives."""
    page.wait_for_selector("canvas")
    notice = page.get_by_role("alert").get_by_role("button")
    if notice.count():
        notice.first.click()
    page.wait_for_timeout(4000)


@contextmanager
def operated(page: Page, subject: Subject, now: Now, folder: Path) -> Iterator[Cockpit]:
    """The page of a run whose expert is a person, opened; its episodes go to `folder`/recorded."""
    task, adjusting = subject.task, subject.adjusting
    assert adjusting is not None
    # A person who waits for the film's next scene is no operator who was lost.
    operating = Operating(wait_s=600.0, speed=SPEED)
    shown: Future[tuple[str, Cockpit]] = Future()
    session = Session(lambda: Catalog({}, {}), "", *(Console(file=io.StringIO()) for _ in range(2)))
    recorder = Recorder(EpisodeStore.create(folder / "recorded"))

    def drive() -> None:
        address = Address(port=0)
        with (
            operating.crew(task, address, session, adjusting.widgets, adjusting.explainer) as crew,
            SerialExecutor() as executor,
        ):
            shown.set_result((crew.page.address, crew.cockpit))
            if adjusting.states is not None:
                crew.page.on_fit(adjusting.states)
            by_hand, driver = replace(subject, task=crew.operated()), crew.driver(adjusting.driver)
            requests = (by_hand.request(driver, "person", at) for at in count())
            for _ in run_all(executor, requests, listeners=(*crew.listeners, recorder, now)):
                if crew.cockpit.closed:
                    break

    with ThreadPoolExecutor(1) as pool:
        run = pool.submit(drive)
        wait_until(lambda: shown.done() or run.done(), "page", page)
        if run.done():
            run.result()
        address, cockpit = shown.result()
        try:
            open_dashboard(page, address)
            settle(page)
            yield cockpit
        finally:
            cockpit.end(Ending.SAVE)
            cockpit.close()
        run.result()


def served(reel: Reel, cockpit: Cockpit, hands: Hands) -> None:
    """A person watches, is asked, drives, hands back, and stops it all."""
    page = reel.page

    def tab(name: str) -> None:
        page.get_by_role("tab", name=name, exact=True).click()

    def serve(seconds: float, words: str) -> None:
        page.keyboard.press("t")
        wait_until(lambda: cockpit.state.taken, "takeover", page)
        # A turn begins by any key.
        hands.hold(frozenset({"KeyJ"}))
        reel.roll(seconds, words, hands.drive)
        hands.hold(frozenset())
        page.keyboard.press("h")

    tab("Run")
    reel.roll(4, "A policy that learned from a few laps is about to drive. H lets it begin.")
    page.keyboard.press("h")
    watched = "The policy drives. Its gate looks at each proposal: is this like what it learned?"
    reel.roll_until(lambda: cockpit.state.asking, watched, 20)
    reel.roll(5, "Below the threshold: the robot holds, calls, and says why.")
    tab("Why")
    reel.roll(8, "Which signal rang, the training states most like this one, where it would lead.")
    tab("Run")
    serve(10, "T takes over; the keys that drive lie over the scene.")
    reel.roll_until(lambda: cockpit.state.asking, "H hands back: the policy drives again.", 12)
    tab("What if")
    reel.roll(7, "What if the threshold lay elsewhere? Seen on what is recorded, before it acts.")
    tab("Run")
    if cockpit.state.asking:
        serve(8, "Each request is counted: how often, how long, how many labels.")
    reel.roll_until(lambda: cockpit.state.asking, "The policy goes on.", 10)
    page.keyboard.press("Space")
    wait_until(lambda: cockpit.state.stopped, "stop", page)
    reel.roll(5, "Space stops the robot, no matter who drives, until it is reset with R.")
    page.keyboard.press("r")
    wait_until(lambda: not cockpit.state.stopped, "reset", page)
    page.keyboard.press("p")


def looked_back(reel: Reel, subject: Subject, folder: Path) -> None:
    """The replay of what was recorded, its timeline, and the wall of moments."""
    assert subject.checkpoint is not None
    assert subject.adjusting is not None
    page, catalog = reel.page, EpisodeCatalog(EpisodeStore(folder / "recorded"))
    fitted, explainer = subject.checkpoint.fitted, subject.adjusting.explainer
    with replayed(page, subject.task, catalog, explainer, fitted):
        settle(page)
        page.wait_for_function("window.sheathSeek?.open && window.sheathWall")
        reel.roll(10, "All of it is recorded: replay, with J K L and the arrows.")
        page.keyboard.press("k")
        strip = page.locator("[data-sheath-span]")
        for share in (0.2, 0.4, 0.6, 0.8):
            strip.click(position={"x": share * drawn_width(strip, page), "y": 10})
            reel.roll(2, "A click on the timeline seeks; colours say who acted.")
        page.keyboard.press("o")
        page.locator("#sheath-wall .tile img").first.wait_for()
        reel.roll(10, "O: the wall of moments, failures, takeovers and near misses, worst first.")
        page.keyboard.press("Enter")
        reel.roll(7, "Enter shows one in the replay.")
        page.keyboard.press("c")
        reel.roll(5, "C makes a clip of any stretch.")


def learned(reel: Reel, task: Task, runs: Path) -> None:
    """The learning curves of an experiment, as they grow, and the numbers of a round."""
    page, results = reel.page, results_of(runs)
    environment = task.make()
    with Dashboard(environment.spec, port=0) as dashboard:
        dashboard.on_start(environment, info_of(environment.spec, results[0]))
        open_dashboard(page, dashboard.address)
        settle(page)
        page.get_by_role("tab", name="Learning").click()
        words = "While it learns: each method's rounds, with 95 % intervals and each training seed."
        for number, result in enumerate(results):
            dashboard.on_round(result)
            # So it is between rounds, and no picture is late.
            share = number / len(results)
            dashboard.on_work(Work(f"fitting round {result.round + 1}", share))
            if number % (len(results) // GROWN) == 0:
                reel.roll(0.5, words)
        reel.roll(2, words)
        chart = page.locator("[data-sheath-chart]").first
        chart.focus()
        for _ in range(4):
            page.keyboard.press("ArrowLeft")
            reel.roll(2, "Point at a round, or go there by the arrows: its numbers.")
    environment.close()


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, help="the mp4")
    parser.add_argument("--checkpoint", type=Path, help="of the policy and its gate")
    parser.add_argument("--store", type=Path, help="of the episodes that it was fitted to")
    parser.add_argument(
        "--learned", nargs=2, metavar=("TASK", "RUNS"), help="an experiment that has run"
    )
    options = parser.parse_args(arguments)
    options.expert = False
    task = TASKS["driving"]
    with tempfile.TemporaryDirectory() as name, single_threaded(), chromium_page() as page:
        folder, twin = Path(name), task.make()
        subject = subject_of(task, options, twin.spec, folder)
        reel, now = Reel(page), Now()
        hands = Hands(page, now, Eyes(twin, task.make_expert(twin)))
        with operated(page, subject, now, folder) as cockpit:
            served(reel, cockpit, hands)
        looked_back(reel, subject, folder)
        twin.close()
        if options.learned is not None:
            name, runs = options.learned
            learned(reel, TASKS[name], Path(runs))
    options.out.write_bytes(mp4(reel.shown(), RATE_HZ))
    print(f"{options.out}: {reel.clock_s:.0f} s, {options.out.stat().st_size / 1e6:.1f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
