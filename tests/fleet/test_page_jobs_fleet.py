"""The job of who serves several robots, by keyboard alone: see who asks, choose, serve, stop."""

from dataclasses import replace

import pytest
from playwright.sync_api import Page

from sheath_manip.cockpit import Order
from tests.browser import await_no_serious_fault, resize
from tests.by_keyboard import AT_EACH_SIZE, press_on
from tests.fleet.told_robots import ASKS, DRIVES, SERVED, Robots, notice, served_at, words
from tools.chromium import open_dashboard, wait_until

pytestmark = pytest.mark.browser


@pytest.mark.parametrize("size", AT_EACH_SIZE)
def test_one_serves_several_robots(browser_page: Page, size: str) -> None:
    page, robots = browser_page, Robots()
    states = {1: DRIVES, 2: ASKS, 3: ASKS, 4: DRIVES}
    robots.asks(2, below=0.5)
    robots.asks(3, below=0.1)

    def says(begins: str) -> None:
        wait_until(lambda: notice(page).startswith(begins), f"the notice {begins!r}", page)

    resize(page, size)
    with served_at(robots, states) as dashboard:
        open_dashboard(page, dashboard.address)
        says("Robot 2 holds and asks")
        wait_until(lambda: words(page)[2].startswith("waiting, 2nd"), "strip", page)
        page.keyboard.press("x")
        says("Robot 3 holds and asks")
        # Any tile by Tab, too.
        press_on(page, page.locator("#sheath-robots button").nth(1))
        says("Robot 2 holds and asks")
        await_no_serious_fault(page)
        page.keyboard.press("t")
        wait_until(lambda: robots.told[1].orders() == [Order.TAKE_OVER], "order", page)
        states[2] = SERVED
        wait_until(lambda: words(page)[1] == "being served", "served", page)
        states[2] = replace(DRIVES)
        page.keyboard.press("h")
        says("Robot 3 holds and asks")
        page.keyboard.press("Space")
        wait_until(lambda: "EMERGENCY STOP of all robots" in notice(page), "stop", page)
        assert all(told.orders()[-1] is Order.STOP for told in robots.told)
