"""Measure how soon the wall of moments is there, and filtered, with many episodes.

    python -m tools.bench_wall [--quick]

Writes results/bench-wall.json. The episodes are index entries without steps, but for those of a
small store, of which moments and pictures are made.
"""

import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from playwright.sync_api import Page

from sheath_manip.dashboard import Replay
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.wall.thumbnails import Thumbnails
from sheath_manip.dataset.moment_notes import all_moments
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.playback.film import Film
from sheath_manip.types import ActionSpec, TaskSpec
from tools.bench import Line, at_most, run_bench, spent_s
from tools.chromium import chromium_page, open_dashboard, wait_until
from tools.synthetic import synthetic_episode, synthetic_info
from tools.synthetic_store import SyntheticStore

PAINT_S, FILTER_S = 2.0, 0.2
WORDS = ("sheath", "risk", "seed4", "dagger s7", "")
"""that are typed into the filter one after the other"""
TILES = "#sheath-wall[open] .tile"
_SIDES = np.ones(2, np.float32)
SPEC = TaskSpec(
    name="synthetic",
    control_rate_hz=10.0,
    action=ActionSpec(("x", "y"), -_SIDES, _SIDES),
    cameras={},
    feature_names=tuple("abcdef"),
    max_steps=300,
    metric="distance_m",
)


@dataclass(frozen=True)
class Sizes:
    """How much is measured."""

    episodes: int = 10_000
    stored: int = 40
    steps: int = 300
    pixels: int = 84


QUICK = Sizes(episodes=1000, stored=4, steps=80, pixels=32)


def working_s(page: Page, act: Callable[[], object]) -> float:
    """Return the CPU seconds that the page's own thread and this process work for `act`.

    Other processes on the machine do not move them, as they move what a clock says.
    """
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})

    def page_s() -> float:
        found = session.send("Performance.getMetrics")["metrics"]
        return next(each["value"] for each in found if each["name"] == "TaskDuration")

    before_s, here_s = page_s(), time.process_time()
    act()
    page.evaluate("new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
    spent = page_s() - before_s + time.process_time() - here_s
    session.detach()
    return spent


def paint_s(page: Page) -> float:
    """Return the CPU seconds from the key that opens the wall to its first tiles on the screen."""

    def act() -> None:
        page.keyboard.press("o")
        page.wait_for_selector(TILES)

    return working_s(page, act)


def filter_s(page: Page) -> float:
    """Return the most CPU seconds from a change of the text to the tiles that fit."""
    field = page.locator("#sheath-wall input[type=search]")
    return max(working_s(page, partial(field.fill, words)) for words in WORDS)


def nothing_to_see(store: EpisodeReader) -> Replay:
    """Return a page of `store` that can show no episode."""

    def none(*_: object) -> Film:
        raise StoreError("synthetic episodes have no steps; look at the wall only")

    return Replay(SPEC, EpisodeCatalog(store), none, none, none, port=0)  # pyright: ignore[reportArgumentType]


def wall_lines(sizes: Sizes) -> dict[str, Line]:
    """First paint and filters, in Chromium."""
    store = SyntheticStore(sizes.episodes)
    with nothing_to_see(store) as replay, chromium_page() as page:
        run = threading.Thread(target=replay.run, args=(0,), daemon=True)
        run.start()
        begun_s = time.perf_counter()
        open_dashboard(page, replay.address)
        page.wait_for_function("window.sheathWall && window.sheathSeek?.open")
        page_s = time.perf_counter() - begun_s
        shelf = replay._wall._shelf
        wait_until(lambda: shelf._read == sizes.episodes, "moments", page)
        begun_s = time.perf_counter()
        first_s = paint_s(page)
        clock_s = time.perf_counter() - begun_s
        count = page.evaluate("sheathWall.count")
        later_s = filter_s(page)
        told_s = spent_s(lambda: shelf._encoded(sizes.episodes))
        told_mb = len(shelf.told()) / 1e6
        page.keyboard.press("Escape")
    run.join()
    share = sizes.episodes / 10_000
    return {
        "the wall is there": at_most(
            first_s / share,
            PAINT_S,
            "s",
            f"from the key to {count} moments of {sizes.episodes} episodes, CPU time of page and "
            f"server; {clock_s:.1f} s by the clock, and {page_s:.1f} s before it for the page "
            f"itself; the list takes {told_s:.2f} s once, and {told_mb:.2f} MB, zipped",
        ),
        "the wall is filtered": at_most(
            later_s / share, FILTER_S, "s", f"CPU time, the longest of {len(WORDS)} texts"
        ),
    }


def making_lines(sizes: Sizes) -> dict[str, Line]:
    """What moments and pictures take the first time, and when they are kept."""
    with tempfile.TemporaryDirectory(dir=".") as folder:
        store = EpisodeStore.create(Path(folder, "store"))
        for index in range(sizes.stored):
            store.append(synthetic_episode(synthetic_info(0, index), sizes.steps, sizes.pixels))
        first_s, again_s = (spent_s(lambda: list(all_moments(store))) for _ in range(2))
        strips = Thumbnails(EpisodeCatalog(store))
        calls = [partial(strips.strip, place, sizes.steps // 2) for place in range(sizes.stored)]
        made, kept = (np.array([spent_s(call) for call in calls]) for _ in range(2))
    share = 10_000 / sizes.stored
    return {
        "moments of 10,000 noted episodes": at_most(
            share * again_s,
            2,
            "s",
            f"CPU time, from {sizes.stored} of {sizes.steps} steps; {share * first_s:.0f} s the "
            "first time, in the background",
        ),
        "a picture is made": at_most(
            1e3 * float(np.median(made)),
            50,
            "ms",
            f"CPU time, {sizes.pixels}×{sizes.pixels}; {1e3 * float(np.median(kept)):.2f} ms once "
            "it is kept",
        ),
    }


def main(arguments: Sequence[str] | None = None) -> None:
    """Run from the command line."""
    run_bench("wall", __doc__, (wall_lines, making_lines), Sizes(), QUICK, arguments)


if __name__ == "__main__":
    main()
