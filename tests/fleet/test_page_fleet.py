"""The page of several robots in Chromium: the strip, who is shown, and where orders go."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import pytest
from playwright.sync_api import Page

from sheath_manip.cockpit import Order
from sheath_manip.cockpit.state import State
from sheath_manip.dashboard import Dashboard
from tests.fleet.told_robots import ASKS, DRIVES, SERVED, Robots
from tests.toy import Corridor
from tools.chromium import chromium_page, open_dashboard, wait_until

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def chromium() -> Iterator[Page]:
    with chromium_page() as page:
        yield page


@contextmanager
def shown(robots: Robots, states: dict[int, State]) -> Iterator[Dashboard]:
    """Their page, while they say again and again what `states` has."""
    over = threading.Event()

    def report() -> None:
        while not over.wait(0.1):
            for number, state in states.items():
                robots.says(number, state)

    with Dashboard(
        Corridor().spec,
        port=0,
        cockpit=robots.cockpit,
        pictures=robots.cockpit.roster.pictures,
    ) as page:
        robots.cockpit.on_film = page.show
        thread = threading.Thread(target=report, daemon=True)
        thread.start()
        yield page
        over.set()
        thread.join()


def words(page: Page) -> list[str]:
    return page.locator("#sheath-robots span").all_inner_texts()


def notice(page: Page) -> str:
    return page.locator("#sheath-operator").inner_text()


def test_a_person_sees_who_asks_chooses_and_serves_one_after_another(chromium):
    page, robots = chromium, Robots()
    states = {1: DRIVES, 2: ASKS, 3: ASKS, 4: DRIVES}
    robots.asks(2, below=0.5)
    robots.asks(3, below=0.1)
    with shown(robots, states) as dashboard:
        open_dashboard(page, dashboard.address)
        page.wait_for_selector("#sheath-robots button")
        wait_until(lambda: "waiting, 2nd" in " ".join(words(page)), "strip", page)
        assert [each.split(" for ")[0] for each in words(page)] == [
            "driving",
            "asking",
            "waiting, 2nd,",
            "driving",
        ]
        wait_until(lambda: notice(page).startswith("Robot 2 holds and asks"), "notice", page)
        assert "One more waits" in notice(page)
        # What each that asks sees, small.
        wait_until(lambda: page.locator("#sheath-robots img:visible").count() == 2, "images", page)
        page.keyboard.press("x")
        wait_until(lambda: notice(page).startswith("Robot 3"), "next", page)
        page.locator("#sheath-robots button").nth(1).click()
        wait_until(lambda: notice(page).startswith("Robot 2"), "choice", page)
        assert page.locator("#sheath-robots [aria-pressed=true] b").inner_text() == "Robot 2"
        page.keyboard.press("t")
        wait_until(lambda: robots.told[1].orders() == [Order.TAKE_OVER], "order", page)
        states[2] = SERVED
        wait_until(lambda: words(page)[1] == "being served", "served", page)
        states[2] = replace(DRIVES)
        page.keyboard.press("h")
        wait_until(lambda: notice(page).startswith("Robot 3 holds and asks"), "offer", page)
        page.set_viewport_size({"width": 390, "height": 844})
        tiles = [tile.bounding_box() for tile in page.locator("#sheath-robots button").all()]
        wait_until(
            lambda: all(
                box is not None and box["x"] >= 0 and box["x"] + box["width"] <= 390
                for box in tiles
            ),
            "tiles on a phone",
            page,
        )
        page.locator("#sheath-stop").click()
        wait_until(lambda: "EMERGENCY STOP of all robots" in notice(page), "stop", page)
        assert all(told.orders()[-1] is Order.STOP for told in robots.told)
