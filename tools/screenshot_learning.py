"""Take pictures of the page's learning curves, with the rounds of an experiment that has run.

    python -m tools.screenshot_learning DIRECTORY RUNS TASK

RUNS is the experiment's own folder, of `sheath experiment TASK --runs RUNS`. Nothing is run for a
picture: the results are told to a page in the order in which the experiment came to them, but for
the last ones, so that it is seen at work, as far as it had come by then.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from playwright.sync_api import Page

from sheath_manip.dashboard import Dashboard
from sheath_manip.learning.headway import time_left_s
from sheath_manip.learning.results import EXPERT, RoundResult, round_results
from sheath_manip.task import Task
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import EpisodeInfo, Purpose, TaskSpec
from sheath_manip.types.work import Headway, Work
from tools.chromium import chromium_page, open_dashboard, take_picture

SIZES = {"": (1400, 900), "-phone": (390, 844)}
SETTLED_MS = 3000
"""for the 3-D scene to be drawn in software"""
CLOSED_PX = 90
"""how tall viser's panel is at most where it is closed, below the scene of a phone"""
LEFT_OUT = 3
"""of the newest results"""
FITTED = 0.4
"""of the next round's policy"""


def results_of(runs: Path) -> list[RoundResult]:
    """Return all rounds of all methods and seeds, a method after the other."""
    found = []
    for method in sorted({path.name for path in runs.glob("s[0-9]*/*")} - {EXPERT}):
        for folder in sorted(runs.glob(f"s[0-9]*/{method}")):
            found += round_results(runs, int(folder.parent.name.removeprefix("s")), method)
    return found


def units_of(result: RoundResult) -> int:
    """Return how many episodes and fits a round was."""
    return len(result.executed) + 1 + len(result.policy) + len(result.final)


def tell(dashboard: Dashboard, task: Task, results: Sequence[RoundResult], wall_s: float) -> None:
    """Tell the page of the results, and that the next round's policy is being fitted.

    The run took `wall_s`, the last results included, of which the page is not told.
    """
    told = results[:-LEFT_OUT]
    for result in told:
        dashboard.on_round(result)
    done, units = (sum(map(units_of, each)) for each in (told, results))
    dashboard.on_headway(Headway(done, units, time_left_s(wall_s * done / units, done / units)))
    last, environment = told[-1], task.make()
    environment.reset(0)
    info = info_of(environment.spec, last)
    dashboard.on_start(environment, info)
    dashboard.on_work(Work(f"fitting round {info.round}", FITTED))
    environment.close()


def info_of(spec: TaskSpec, result: RoundResult) -> EpisodeInfo:
    """Return the info of an episode of the round after `result`."""
    return EpisodeInfo.of(
        spec,
        variant="default",
        seed=0,
        purpose=Purpose.LEARNING,
        method=result.method,
        round=result.round + 1,
        index=0,
        run_seed=result.run_seed,
    )


def photograph(page: Page, out: Path) -> None:
    """Write the tab at both sizes, light and dark, with the numbers of a round before it."""
    for dark in (False, True):
        page.emulate_media(color_scheme="dark" if dark else "light")
        for name, (width, height) in SIZES.items():
            page.set_viewport_size({"width": width, "height": height})
            page.wait_for_timeout(SETTLED_MS)
            # A notice that only a browser without a graphics card gives.
            for notice in page.get_by_role("alert").get_by_role("button").all():
                notice.click()
            sheet = page.locator(".sheath-sheet")
            if sheet.count() and sheet.evaluate("(it) => it.clientHeight") < CLOSED_PX:
                sheet.get_by_role("button", name="Panel").click()
            page.get_by_role("tab", name="Learning").click()
            page.wait_for_timeout(SETTLED_MS)
            page.locator("[data-sheath-chart]").first.focus()
            page.keyboard.press("ArrowLeft")
            page.locator("#sheath-hover").wait_for()
            take_picture(page, out / f"learning{name}{'-dark' if dark else ''}.png")
            page.keyboard.press("Escape")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("out", type=Path, help="directory for the PNGs")
    parser.add_argument("runs", type=Path, help="folder of the experiment")
    parser.add_argument("task", choices=sorted(TASKS))
    options = parser.parse_args(arguments)
    options.out.mkdir(parents=True, exist_ok=True)
    task, results = TASKS[options.task], results_of(options.runs)
    wall_s = json.loads((options.runs / "wall.json").read_text())["wall_s"]
    environment = task.make()
    environment.close()
    with chromium_page() as page, Dashboard(environment.spec, port=0) as dashboard:
        tell(dashboard, task, results, wall_s)
        open_dashboard(page, dashboard.address)
        page.wait_for_selector("canvas")
        page.get_by_role("tab", name="Learning").click()
        page.locator("[data-sheath-chart]").first.wait_for()
        photograph(page, options.out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
