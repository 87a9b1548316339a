"""What the page says of who acts, in Chromium: the notice over the scene, and the banner."""

from collections.abc import Iterator
from dataclasses import dataclass

import pytest
from playwright.sync_api import Page

from sheath_manip.playback import palette
from sheath_manip.types import Actor, Reason
from tests.by_keyboard import hold_until
from tests.cockpit.operated_grasp import FALLBACK, WAIT_S, OperatedGrasp, operated_grasp
from tools.chromium import chromium_page, open_dashboard, wait_until

pytestmark = pytest.mark.browser
ASKING, DRIVING, STOPPED = "rgb(179, 79, 0)", "rgb(0, 122, 90)", "rgb(190, 30, 45)"


@dataclass(frozen=True)
class Shown:
    """What is to be seen at once."""

    notice: str
    """how the notice begins; empty where there is none"""
    colour: str
    """of the notice, as a browser says it"""
    banner: str
    reason: Reason
    actor: Actor


@pytest.fixture(scope="module")
def grasp() -> Iterator[OperatedGrasp]:
    with operated_grasp() as grasp:
        yield grasp


@pytest.fixture(scope="module")
def page(grasp) -> Iterator[Page]:
    with chromium_page() as page:
        open_dashboard(page, grasp.page.address)
        page.get_by_role("button", name="Take over (T)").wait_for()
        page.wait_for_function("window.sheathOperator?.state.operated")
        yield page


def css(rgb: palette.Rgb) -> str:
    red, green, blue = rgb
    return f"rgb({red}, {green}, {blue})"


def await_shown(page: Page, grasp: OperatedGrasp, shown: Shown) -> None:
    """Wait until the page says so, in the colours that go with it, and the robot does so."""
    grasp.until_turn(shown.actor)
    assert grasp.steps[-1].decision.reason is shown.reason
    title = page.get_by_text(shown.banner, exact=True).first
    title.wait_for()
    box = "(title) => getComputedStyle(title.parentElement).backgroundColor"
    colour = css(palette.turn(shown.actor, shown.reason))
    wait_until(lambda: title.evaluate(box) == colour, f"{shown.banner} in {colour}", page)
    notice = page.locator("#sheath-operator")

    def says() -> bool:
        # At once: on a busy machine the picture may grow old, which it says in between.
        text, ground = notice.evaluate(
            "(it) => [it.textContent, getComputedStyle(it).backgroundColor]"
        )
        if not shown.notice:
            return not notice.is_visible()
        return text.startswith(shown.notice) and ground == shown.colour

    wait_until(says, f"the notice {shown.notice!r} in {shown.colour}", page)


def test_the_page_says_at_each_moment_who_acts(grasp, page):
    await_shown(page, grasp, Shown("", "", "Policy acts", Reason.INSIDE, Actor.POLICY))

    grasp.inside = False
    asks = f"The robot holds and asks for you: take over with T. The {FALLBACK} acts in"
    await_shown(page, grasp, Shown(asks, ASKING, "Robot holds", Reason.WAITING, Actor.HOLD))
    heard = page.evaluate("sheathOperator.beeps")
    page.wait_for_function(f"sheathOperator.beeps > {heard}")

    grasp.gate.wait_s = 0.0
    nobody = f"Nobody came, so the {FALLBACK} acts. Take over with T."
    acts = f"{FALLBACK} acts".capitalize()
    await_shown(page, grasp, Shown(nobody, ASKING, acts, Reason.NO_ANSWER, Actor.FALLBACK))

    page.keyboard.press("t")
    taken = "You have taken over; the robot holds until you move it. H hands back."
    await_shown(page, grasp, Shown(taken, DRIVING, "Robot holds", Reason.IDLE, Actor.HOLD))

    hold_until(page, "u", lambda: grasp.turns[-1][1] is Actor.OPERATOR, "turn")
    drives = "You drive. H hands back, Space stops."
    await_shown(page, grasp, Shown(drives, DRIVING, "Operator acts", Reason.PERSON, Actor.OPERATOR))
    page.get_by_text("operator: person").wait_for()

    page.keyboard.press("Space")
    stop = "EMERGENCY STOP. R resets it."
    await_shown(page, grasp, Shown(stop, STOPPED, "Robot holds", Reason.EMERGENCY_STOP, Actor.HOLD))
    page.keyboard.up("u")

    page.keyboard.press("r")
    page.keyboard.press("p")
    lost = "The robot holds, since nobody drives any longer."
    await_shown(page, grasp, Shown(lost, ASKING, "Robot holds", Reason.WAITING, Actor.HOLD))

    grasp.inside, grasp.gate.wait_s = True, WAIT_S
    page.keyboard.press("h")
    await_shown(page, grasp, Shown("", "", "Policy acts", Reason.INSIDE, Actor.POLICY))
