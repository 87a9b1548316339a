"""The page as Chromium shows it; the server's state is asserted first, the page's second."""

import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page, sync_playwright

from sheath_manip.dashboard import Dashboard, replay
from sheath_manip.protocols import Environment
from sheath_manip.types import Episode

pytestmark = pytest.mark.browser

CHROMIUM = Path("/usr/bin/chromium")
TIMEOUT_MS = 60_000
# Mesa draws in software some forty times as fast as Chromium's own SwiftShader.
FLAGS = [
    "--use-gl=angle",
    "--use-angle=gl-egl",
    "--ignore-gpu-blocklist",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
]


@pytest.fixture(scope="module")
def browser_page() -> Iterator[Page]:
    if not CHROMIUM.exists():
        pytest.fail(f"{CHROMIUM} is missing; `apt-get install chromium` or `make test` installs it")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page(viewport={"width": 1400, "height": 900})
        page.set_default_timeout(TIMEOUT_MS)
        yield page
        browser.close()


def wait_until(condition: Callable[[], bool], what: str, page: Page) -> None:
    deadline_s = time.monotonic() + TIMEOUT_MS / 1000
    while not condition():
        assert time.monotonic() < deadline_s, f"no {what} within {TIMEOUT_MS / 1000:.0f} s"
        # Not time.sleep, because the page's events are handled in here.
        page.wait_for_timeout(50)


def test_page_shows_and_pauses_a_run(
    dashboard: Dashboard,
    environment: Environment,
    episode: Episode,
    training: NDArray,
    browser_page: Page,
    tmp_path: Path,
) -> None:
    page, panel = browser_page, dashboard._page.panel
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    dashboard.show_training(training)
    run = threading.Thread(target=replay, args=(dashboard, environment, episode, 1.0))
    page.goto(dashboard.address)
    run.start()

    wait_until(lambda: dashboard._page.watched, "browser at the server", page)
    wait_until(lambda: panel._scores.visible and len(panel._scores.data[0]) > 5, "scores", page)
    wait_until(lambda: panel._support.visible, "support picture", page)
    assert "token" not in page.url
    page.wait_for_selector("canvas")
    page.wait_for_selector(".u-over")
    page.get_by_text("of 250").wait_for()
    # A task's name is text, whatever it looks like.
    assert page.get_by_text("ring <b>road</b>").count() > 0
    assert page.locator("b", has_text="road").count() == 0
    wait_until(lambda: page.locator("img").count() >= 2, "pictures on the page", page)

    page.get_by_role("button", name="Pause").click()
    wait_until(lambda: dashboard.paused, "pause at the server", page)
    page.get_by_role("button", name="Resume").wait_for()
    page.screenshot(path=tmp_path / "dashboard.png", timeout=TIMEOUT_MS)
    assert run.is_alive()
    page.get_by_role("button", name="Resume").click()
    wait_until(lambda: not dashboard.paused, "resumption at the server", page)

    run.join(30)
    assert not run.is_alive()
    page.get_by_text("episode over").wait_for()
    assert not errors
