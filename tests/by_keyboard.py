"""The pages by keyboard alone, at three sizes."""

import time
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, Page

from tests.browser import SIZES
from tools.chromium import TIMEOUT_S, wait_until

QUICK = "phone"
"""the size at which most has to be opened first, and which is drawn fastest"""
AT_EACH_SIZE = [
    pytest.param(size, marks=() if size == QUICK else pytest.mark.soak) for size in SIZES
]
"""for `pytest.fixture` and `parametrize`; all but one are too slow for `make test`"""
WIDEST_SHEET_PX = 576
"""viser's own border between a panel beside the scene and a sheet below it"""
PATIENCE_S = 3.0
"""after which a person presses a key again that does nothing"""
MOST_TABS = 150
"""more than any page has to go through"""


def has_focus(page: Page, wanted: Locator) -> bool:
    """Whether `wanted` is there and has the focus."""
    return wanted.and_(page.locator(":focus")).count() > 0


def tab_to(page: Page, wanted: Locator) -> None:
    """Press Tab until `wanted` has the focus."""
    wanted.first.wait_for()
    for _ in range(MOST_TABS):
        if has_focus(page, wanted):
            return
        page.keyboard.press("Tab")
    pytest.fail(f"Tab does not reach {wanted}")


def press_on(page: Page, wanted: Locator, key: str = "Enter") -> None:
    """Go to `wanted` by Tab, and press `key` there."""
    tab_to(page, wanted)
    page.keyboard.press(key)


def open_panel(page: Page) -> None:
    """On a phone open the sheet that holds viser's panel; elsewhere it is always there."""
    size = page.viewport_size
    if size is None or size["width"] > WIDEST_SHEET_PX:
        return
    opener = page.get_by_role("button", name="Panel", exact=True)
    opener.wait_for()
    if opener.get_attribute("aria-expanded") == "false":
        press_on(page, opener)
        page.locator(".sheath-opener[aria-expanded=true]").wait_for()


def open_tab(page: Page, name: str) -> None:
    """Open the tab of that name of the panel: Tab goes to the one that is open, arrows from there.

    viser's tabs beside the scene end at both ends, those in a phone's sheet go round.
    """
    open_panel(page)
    wanted = page.get_by_role("tab", name=name, exact=True)
    tabs = page.get_by_role("tablist").filter(has=wanted).get_by_role("tab")
    selected = page.locator("[aria-selected=true]")
    tab_to(page, tabs.and_(selected))
    names = tabs.all_inner_texts()
    way = names.index(name) - names.index(tabs.and_(selected).inner_text())
    for _ in range(abs(way)):
        before = tabs.and_(selected).inner_text()
        page.keyboard.press("ArrowRight" if way > 0 else "ArrowLeft")
        wait_until(lambda before=before: tabs.and_(selected).inner_text() != before, "tab", page)
    wanted.and_(selected).wait_for()


def hold_until(page: Page, key: str, condition: Callable[[], bool], what: str) -> None:
    """Hold `key` down until `condition`, and further; raises TimeoutError naming `what`.

    A page that was drawn too late, as on a busy machine, has let go of it: then it is pressed anew.
    """
    deadline_s, pressed_s = time.monotonic() + TIMEOUT_S, time.monotonic()
    page.keyboard.down(key)
    while not condition():
        now_s = time.monotonic()
        if now_s > deadline_s:
            raise TimeoutError(f"no {what} within {TIMEOUT_S:.0f} s")
        if now_s - pressed_s > PATIENCE_S:
            page.keyboard.up(key)
            page.keyboard.down(key)
            pressed_s = now_s
        # Not time.sleep, because the page's events are handled in here.
        page.wait_for_timeout(50)
