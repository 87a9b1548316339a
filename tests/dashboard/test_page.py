"""The page as Chromium shows it; the server's state is asserted first, the page's second."""

import threading
from pathlib import Path

import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page

from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.widgets.score_plot import ScorePlot
from sheath_manip.dashboard.widgets.support_map import SupportMap
from sheath_manip.protocols import Environment
from sheath_manip.types import Episode
from tests.dashboard.conftest import play, states_at
from tools.chromium import TIMEOUT_S, open_dashboard, wait_until

pytestmark = pytest.mark.browser


def test_page_shows_and_pauses_a_run(
    dashboard: Dashboard,
    environment: Environment,
    episode: Episode,
    training: NDArray,
    browser_page: Page,
    tmp_path: Path,
) -> None:
    page = browser_page
    plot, plane = dashboard._page.widget(ScorePlot), dashboard._page.widget(SupportMap)
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    dashboard.on_fit(states_at(training))
    enough = threading.Event()

    def replay_again_and_again() -> None:
        while not enough.is_set():
            play(dashboard, environment, episode, 1.0)

    run = threading.Thread(target=replay_again_and_again, daemon=True)
    open_dashboard(page, dashboard.address)
    run.start()

    wait_until(lambda: dashboard._page.watched, "browser at the server", page)
    wait_until(lambda: plot._scores.visible and len(plot._scores.data[0]) > 5, "scores", page)
    wait_until(lambda: plane._image.visible, "support picture", page)
    assert "token" not in page.url
    page.wait_for_selector("canvas")
    page.wait_for_selector(".u-over")
    page.get_by_text("of 250").wait_for()
    # A task's name is text, whatever it looks like.
    page.get_by_text("ring <b>road</b>").first.wait_for()
    assert page.locator("b", has_text="road").count() == 0
    wait_until(lambda: page.locator("img").count() >= 1, "camera image on the page", page)
    page.get_by_role("tab", name="Support").click()
    wait_until(lambda: page.locator("img").count() >= 2, "pictures on the page", page)
    page.get_by_role("tab", name="Run").click()

    page.get_by_role("button", name="Pause").click()
    wait_until(lambda: dashboard.paused, "pause at the server", page)
    page.get_by_role("button", name="Resume").wait_for()
    page.screenshot(path=tmp_path / "dashboard.png")
    assert run.is_alive()
    enough.set()
    page.get_by_role("button", name="Resume").click()
    wait_until(lambda: not dashboard.paused, "resumption at the server", page)

    run.join(TIMEOUT_S)
    assert not run.is_alive()
    page.get_by_text("episode over").wait_for()
    assert not errors
