"""Take a picture of the dashboard at work on the driving task, for the README.

    python -m tools.screenshot_dashboard docs/dashboard.png --checkpoint FILE.npz --store DIRECTORY

A policy drives under its gate until the expert has taken over; there the run is held, and headless
Chromium takes the picture. Without a checkpoint one is trained first, in about a minute.
"""

import argparse
import io
import sys
import tempfile
import threading
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from itertools import count
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page

from sheath_manip.aggregate import LearningRun
from sheath_manip.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.dashboard import Dashboard
from sheath_manip.dataset.samples import Samples, samples_from
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates.support import SupportGate
from sheath_manip.protocols import Environment
from sheath_manip.results import EXPERT
from sheath_manip.rollout import rollout
from sheath_manip.seeding import generator, scene_seed
from sheath_manip.task import TaskEntry
from sheath_manip.threads import single_threaded
from sheath_manip.types import Actor, Episode, EpisodeInfo, Purpose, Step
from tasks.table import TASKS
from tools.chromium import TIMEOUT_S, chromium_page, open_dashboard, wait_until

MIN_STEPS, MIN_INTERVENTIONS, MIN_TURN_STEPS = 90, 3, 4
"""of the episode in the picture, and of the intervention under way: enough to be seen"""

POSE_TIMEOUT_S = 600.0
"""training included"""


class Pose:
    """A listener that holds the run at the first step worth a picture."""

    def __init__(self) -> None:
        self.struck = threading.Event()
        self.taken = threading.Event()
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
        if (
            self._steps >= MIN_STEPS
            and self._interventions >= MIN_INTERVENTIONS
            and self._turn_steps >= MIN_TURN_STEPS
        ):
            self.struck.set()
            self.taken.wait()

    def on_end(self, episode: Episode) -> None:
        """The next one, then."""


def trained(task: TaskEntry, dashboard: Dashboard) -> Checkpoint:
    """A policy and its gate from a few demonstrations, which the dashboard follows."""
    plan = replace(task.plans["quick"], demonstrations=3, calibration=3, check=1, held_out=1)
    with tempfile.TemporaryDirectory() as folder:
        runs = Path(folder)
        store = EpisodeStore.create(runs / "store")
        learning = LearningRun(task, plan, 0, runs, store, (dashboard,))
        try:
            return learning.prepare().checkpoint
        finally:
            learning.close()


def training_episodes(store: EpisodeStore, checkpoint: Checkpoint) -> Iterable[Episode]:
    """What `checkpoint` was fitted to, without images."""
    seed = checkpoint.run_seed
    yield from store.episodes(Purpose.DEMONSTRATION, EXPERT, run_seed=seed, need_images=False)
    for number in range(1, checkpoint.round + 1):
        yield from store.episodes(
            Purpose.LEARNING, checkpoint.method, number, seed, need_images=False
        )


def drive(
    task: TaskEntry,
    dashboard: Dashboard,
    pose: Pose,
    checkpoint_path: Path | None,
    store_path: Path | None,
    first_scene: int,
) -> None:
    """Run episodes until the picture is taken."""
    environment = task.make()
    try:
        if checkpoint_path is None:
            checkpoint = trained(task, dashboard)
        else:
            checkpoint = load_checkpoint(checkpoint_path, environment.spec)
            if store_path is not None:
                episodes = training_episodes(EpisodeStore(store_path), checkpoint)
                dashboard.on_fit(samples_from(episodes))
        for index in count():
            if pose.taken.is_set():
                break
            info = EpisodeInfo(
                task=task.name,
                seed=scene_seed(Purpose.LEARNING, "screenshot", first_scene + index),
                purpose=Purpose.LEARNING,
                control_rate_hz=environment.spec.control_rate_hz,
                method="sheath",
                round=checkpoint.round + 1,
                index=index,
                run_seed=checkpoint.run_seed,
            )
            rollout(
                environment,
                info,
                SupportGate(checkpoint.score, checkpoint.threshold),
                rng=generator("none"),
                policy=checkpoint.policy,
                expert=task.expert(environment),
                listeners=(dashboard, pose),
            )
    finally:
        environment.close()


def photograph(page: Page, address: str, pose: Pose, run: Future[None]) -> bytes:
    """A PNG of the page once it shows the pose; raises what ended `run` before that."""
    open_dashboard(page, address)
    wait_until(lambda: pose.struck.is_set() or run.done(), "intervention", page, POSE_TIMEOUT_S)
    if run.done():
        run.result()
    page.wait_for_selector("canvas")
    page.get_by_text("Expert acts").wait_for()
    page.wait_for_selector(".u-over")
    # A notice that only a browser without a graphics card gives.
    page.get_by_role("alert").get_by_role("button").click()
    # Support picture and camera image; then a moment for the 3-D scene to be drawn.
    page.wait_for_function("document.querySelectorAll('img[src^=\"blob:\"]').length >= 2")
    page.wait_for_timeout(5000)
    return page.screenshot(timeout=1000 * TIMEOUT_S)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, help="the PNG to write")
    parser.add_argument("--checkpoint", type=Path, help="of the policy and its gate")
    parser.add_argument("--store", type=Path, help="of the episodes that it was fitted to")
    parser.add_argument("--scene", type=int, default=0, help="to begin with, from 0")
    options = parser.parse_args(arguments)
    task = TASKS["driving"]
    environment = task.make()
    environment.close()
    pose = Pose()
    with (
        Dashboard(environment.spec, port=0) as dashboard,
        ThreadPoolExecutor(1) as pool,
        single_threaded(),
        chromium_page() as page,
    ):
        # All in one thread, because a GL context belongs to the one that made it.
        run = pool.submit(
            drive, task, dashboard, pose, options.checkpoint, options.store, options.scene
        )
        try:
            png = photograph(page, dashboard.address, pose, run)
        finally:
            pose.taken.set()
    # 256 colours are enough for what is drawn, at a third of the size; a rare one is kept, too.
    image = Image.open(io.BytesIO(png)).convert("RGB")
    image = image.quantize(256, Image.Quantize.MAXCOVERAGE, kmeans=2, dither=Image.Dither.NONE)
    options.out.parent.mkdir(parents=True, exist_ok=True)
    image.save(options.out, optimize=True)
    print(f"{options.out}: {image.width}x{image.height}, {options.out.stat().st_size / 1e3:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
