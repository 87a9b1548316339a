"""What lies over the scene, in Chromium: what is touched, what calls a person, and names."""

from collections.abc import Iterator

import pytest
from playwright.sync_api import Locator, Page

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.cockpit.shown import Shown
from sheath_manip.dashboard import Dashboard
from sheath_manip.types import Actor
from sheath_manip.types.work import Work
from tests.browser import await_no_serious_fault, resize
from tests.by_keyboard import open_panel
from tests.cockpit.operated_corridor import INFO
from tests.toy import Corridor, teleop
from tools.chromium import chromium_page, open_dashboard, wait_until

pytestmark = pytest.mark.browser
FAKES = """
window.notes = [];
window.Notification = class {
  static permission = "default";
  static async requestPermission() { Notification.permission = "granted"; }
  constructor(title) { this.title = title; window.notes.push(this); }
  close() { this.closed = true; }
};
document.hasFocus = () => false;
"""
"""a system that shows notices, and a person who looks elsewhere"""
CYRILLIC = """
Object.defineProperty(navigator, "keyboard", {
  value: { getLayoutMap: async () => new Map([["KeyJ", "о"], ["KeyL", "д"], ["KeyT", "е"]]) },
});
"""


@pytest.fixture(scope="module")
def cockpit() -> Cockpit:
    return Cockpit(teleop(Corridor()).guide, paced=True, undo_s=3600.0)


@pytest.fixture(scope="module")
def opened(cockpit) -> Iterator[Page]:
    with Dashboard(Corridor().spec, port=0, cockpit=cockpit) as served, chromium_page() as page:
        served.on_start(Corridor(), INFO)
        resize(page, "phone")
        page.add_init_script(FAKES)
        open_dashboard(page, served.address)
        page.wait_for_function("window.sheathOperator?.state.operated")
        yield page


def notice(page: Page) -> str:
    return page.locator("#sheath-operator").inner_text()


def orders(page: Page) -> Locator:
    return page.get_by_role("group", name="Orders")


def test_a_phone_takes_over_drives_stops_and_goes_on_by_touch(cockpit, opened):
    def held() -> frozenset[str]:
        return cockpit.latest_input.keys

    def finger(type_: str) -> None:
        left.dispatch_event(type_, {"pointerId": 7, "bubbles": True})

    # viser's panel is closed below the scene.
    sheet = opened.locator(".sheath-sheet")
    wait_until(lambda: sheet.evaluate("(it) => it.clientHeight") < 90, "closed sheet", opened)
    orders(opened).get_by_role("button", name="Take over").click()
    wait_until(lambda: cockpit.state.taken, "takeover", opened)
    left = opened.get_by_role("button", name="J: left")
    box = left.bounding_box()
    assert box is not None
    assert box["width"] >= 44
    assert box["height"] >= 44
    left.hover()
    opened.mouse.down()
    wait_until(lambda: held() == {"KeyJ"}, "held key", opened)
    opened.mouse.up()
    wait_until(lambda: not held(), "letting go", opened)
    # What a phone does when a call comes in.
    finger("pointerdown")
    wait_until(lambda: held() == {"KeyJ"}, "held key", opened)
    finger("pointercancel")
    wait_until(lambda: not held(), "letting go", opened)
    # The keys are also there to see which of them are held.
    opened.keyboard.down("l")
    opened.get_by_role("button", name="L: right").and_(opened.locator(".held")).wait_for()
    opened.get_by_role("button", name="Emergency stop").click()
    opened.keyboard.up("l")
    wait_until(lambda: cockpit.state.stopped, "stop", opened)
    for name in ("Reset the stop", "Resume", "Let the policy go on"):
        orders(opened).get_by_role("button", name=name).click()
    wait_until(lambda: not (cockpit.paused or cockpit.state.abandoned), "going on", opened)


def test_a_discard_is_called_off(cockpit, opened):
    opened.keyboard.press("z")
    wait_until(lambda: notice(opened).startswith("DISCARDING"), "word of the discard", opened)
    assert "C keeps it" in notice(opened)
    opened.keyboard.press("c")
    wait_until(lambda: not cockpit.discarding, "calling off", opened)
    opened.keyboard.press("z")
    orders(opened).get_by_role("button", name="Keep the episode").click()
    wait_until(lambda: not cockpit.discarding, "calling off", opened)
    assert cockpit.ending is None


def test_the_page_says_what_is_fitted_and_how_far_it_is(cockpit, opened):
    cockpit.between.note_work(Work("fitting round 2", 0.4))
    wait_until(lambda: notice(opened).startswith("FITTING round 2: 40 %"), "fit", opened)
    assert opened.title() == "◔ sheath · corridor"
    cockpit.between.note_work(None)
    wait_until(lambda: not notice(opened), "silence", opened)


def test_the_robot_calls_who_looks_elsewhere(cockpit, opened):
    icon = opened.locator("link[rel=icon]")
    plain = icon.get_attribute("href")
    # Asked once, and never again.
    ask = opened.get_by_role("button", name="Notify me")
    ask.click()
    ask.wait_for(state="hidden")
    cockpit.give_turn(Actor.HOLD, asking=True, left_s=9.0)
    opened.wait_for_function("notes.length === 1")
    assert "▲" in opened.title()
    assert icon.get_attribute("href") != plain
    beeps = opened.evaluate("sheathOperator.beeps")
    opened.get_by_role("button", name="Sound on").click()
    opened.get_by_role("button", name="Sound off").wait_for()
    opened.wait_for_function(f"sheathOperator.beeps > {beeps}")
    cockpit.give_turn(Actor.POLICY)
    opened.wait_for_function("notes[0].closed")
    opened.wait_for_timeout(1100)
    assert opened.evaluate("notes.length") == 1


def test_keys_say_what_another_alphabet_has_printed_on_them(cockpit, opened):
    opened.add_init_script(CYRILLIC)
    opened.reload()
    opened.wait_for_function("window.sheathOperator?.state.operated")
    opened.keyboard.press("t")
    opened.get_by_role("button", name="О: left").wait_for()
    cockpit.order(Order.STOP, "the test")
    cockpit.order(Order.RESET, "the test", shown=Shown(stops=cockpit.state.stops))
    cockpit.resume()
    wait_until(lambda: "Е takes over" in notice(opened), "the letter", opened)
    cockpit.order(Order.HAND_BACK, "the test")


@pytest.mark.parametrize(
    ("size", "dark"),
    [
        ("phone", False),
        pytest.param("phone", True, marks=pytest.mark.soak),
        pytest.param("tablet", False, marks=pytest.mark.soak),
        pytest.param("tablet", True, marks=pytest.mark.soak),
        ("desk", False),
        ("desk", True),
    ],
)
def test_a_checker_finds_no_serious_fault(cockpit, opened, size, dark):
    cockpit.order(Order.TAKE_OVER, "another")
    resize(opened, size)
    opened.emulate_media(color_scheme="dark" if dark else "light")
    opened.locator(f"html[data-mantine-color-scheme={'dark' if dark else 'light'}]").wait_for()
    open_panel(opened)
    await_no_serious_fault(opened)
    cockpit.order(Order.HAND_BACK, "another")
