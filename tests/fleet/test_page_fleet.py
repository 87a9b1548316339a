"""The page of several robots in Chromium: the strip, who is shown, and where orders go."""

from dataclasses import replace

import pytest

from sheath_manip.cockpit import Order
from tests.browser import resize
from tests.fleet.told_robots import ASKS, DRIVES, SERVED, Robots, notice, served_at, words
from tools.chromium import open_dashboard, wait_until

pytestmark = pytest.mark.browser


def test_a_person_sees_who_asks_chooses_and_serves_one_after_another(browser_page):
    page, robots = browser_page, Robots()
    states = {1: DRIVES, 2: ASKS, 3: ASKS, 4: DRIVES}
    robots.asks(2, below=0.5)
    robots.asks(3, below=0.1)
    with served_at(robots, states) as dashboard:
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
        resize(page, "phone")
        tiles = page.locator("#sheath-robots button")

        def fit() -> bool:
            boxes = [tile.bounding_box() for tile in tiles.all()]
            return all(box and box["x"] >= 0 and box["x"] + box["width"] <= 390 for box in boxes)

        wait_until(fit, "tiles on a phone", page)
        page.locator("#sheath-stop").click()
        wait_until(lambda: "EMERGENCY STOP of all robots" in notice(page), "stop", page)
        assert all(told.orders()[-1] is Order.STOP for told in robots.told)
