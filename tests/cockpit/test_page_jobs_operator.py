"""Jobs of who operates, by keyboard alone: a takeover and its end, the stop, why the gate asks."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Page

from sheath_manip.types import Actor, Reason
from tests.browser import await_no_serious_fault, resize
from tests.by_keyboard import AT_EACH_SIZE, hold_until, open_panel, open_tab
from tests.cockpit.operated_grasp import OperatedGrasp, operated_grasp
from tools.chromium import open_dashboard, wait_until

# The same jobs at a desk, by keys and by mouse, are part of `make test`.
pytestmark = [pytest.mark.browser, pytest.mark.soak]


@pytest.fixture(scope="module")
def grasp() -> Iterator[OperatedGrasp]:
    with operated_grasp() as grasp:
        yield grasp


@pytest.fixture(scope="module", params=AT_EACH_SIZE)
def page(request: pytest.FixtureRequest, grasp: OperatedGrasp, browser_page: Page) -> Page:
    """The page of the run, opened anew at each size."""
    resize(browser_page, request.param)
    open_dashboard(browser_page, grasp.page.address)
    browser_page.wait_for_function("window.sheathOperator?.state.operated")
    browser_page.locator("#sheath-stop").wait_for()
    return browser_page


def says(page: Page, words: str) -> None:
    """Wait until the notice says so."""
    notice = page.locator("#sheath-operator")
    wait_until(lambda: words in notice.inner_text(), f"the notice {words!r}", page)


def test_a_person_is_called_takes_over_drives_and_hands_back(
    grasp: OperatedGrasp, page: Page
) -> None:
    heard = page.evaluate("sheathOperator.beeps")
    grasp.inside = False
    says(page, "The robot holds and asks for you: take over with T.")
    page.wait_for_function(f"sheathOperator.beeps > {heard}")
    wait_until(lambda: "▲" in page.title(), "sign in the title", page)
    page.keyboard.press("t")
    says(page, "You have taken over")
    page.get_by_role("button", name="U: ").wait_for()
    await_no_serious_fault(page)
    from_m = grasp.tool_m.copy()
    hold_until(page, "u", lambda: grasp.tool_m[2] > from_m[2] + 0.02, "motion")
    says(page, "You drive.")
    page.keyboard.up("u")
    grasp.inside = True
    page.keyboard.press("h")
    grasp.until_turn(Actor.POLICY)


def test_the_stop_and_its_reset(grasp: OperatedGrasp, page: Page) -> None:
    page.keyboard.press("Space")
    wait_until(lambda: grasp.cockpit.state.stopped, "stop", page)
    says(page, "EMERGENCY STOP. R resets it.")
    await_no_serious_fault(page)
    page.keyboard.press("r")
    wait_until(lambda: not grasp.cockpit.state.stopped, "reset", page)
    says(page, "PAUSED")
    page.keyboard.press("p")
    grasp.until_turn(Actor.POLICY)
    # The same by Tab: the large button is the first that it reaches.
    page.evaluate("document.activeElement?.blur()")
    page.keyboard.press("Tab")
    page.locator("#sheath-stop:focus").wait_for()
    page.keyboard.press("Enter")
    wait_until(lambda: grasp.cockpit.state.stopped, "stop by button", page)
    wait_until(lambda: page.evaluate("sheathOperator.state.stopped"), "its word", page)
    for key in "rp":
        page.keyboard.press(key)
    grasp.until_turn(Actor.POLICY)


def test_one_reads_why_the_gate_fired(grasp: OperatedGrasp, page: Page) -> None:
    grasp.inside = False
    grasp.until_turn(Actor.HOLD)
    assert grasp.steps[-1].decision.reason is Reason.WAITING
    open_panel(page)
    page.get_by_text("The gate asks for another reason than its score.").wait_for()
    page.get_by_text("the policy wants: grip").wait_for()
    open_tab(page, "Why")
    page.get_by_text("This gate does not say what its score is made of.").wait_for()
    page.get_by_text("● policy, ◆ expert").wait_for()
    await_no_serious_fault(page)
    grasp.inside = True
    page.keyboard.press("h")
    grasp.until_turn(Actor.POLICY)
