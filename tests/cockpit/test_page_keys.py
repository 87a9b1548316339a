"""Held keys in Chromium that nobody holds any longer, and letters that lie elsewhere."""

import threading
import time
from collections.abc import Iterator

import pytest
from playwright.sync_api import Page

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.cockpit.shown import Shown
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.access import AccessControl
from tests.browser import SIZES, resize
from tests.by_keyboard import press_on
from tests.cockpit.operated_corridor import INFO
from tests.toy import Corridor, teleop
from tools.chromium import TIMEOUT_S, chromium_page, open_dashboard, wait_until

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def cockpit() -> Cockpit:
    return Cockpit(teleop(Corridor()).guide, paced=True)


@pytest.fixture(scope="module")
def served(cockpit) -> Iterator[Dashboard]:
    with Dashboard(Corridor().spec, port=0, cockpit=cockpit) as page:
        yield page


@pytest.fixture(scope="module")
def opened(served) -> Iterator[Page]:
    with chromium_page() as page:
        # Nothing is drawn in 3-D here.
        page.set_viewport_size({"width": 400, "height": 300})
        open_dashboard(page, served.address)
        page.wait_for_function("window.sheathOperator?.state.operated")
        yield page


@pytest.fixture
def taken(cockpit, opened) -> Iterator[Page]:
    """The page, from which somebody drives; whatever it did is undone."""
    opened.keyboard.press("t")
    wait_until(lambda: cockpit.state.taken, "takeover", opened)
    yield opened
    cockpit.order(Order.STOP, "the test")
    cockpit.order(Order.RESET, "the test", shown=Shown(stops=cockpit.state.stops))
    cockpit.resume()
    cockpit.order(Order.HAND_BACK, "the test")
    # What a page orders that has not seen the newest stop is void.
    stops = cockpit.state.stops
    opened.wait_for_function(f"sheathOperator.state.stops === {stops}")
    opened.wait_for_function("!sheathOperator.state.stopped && !sheathOperator.state.paused")


def held(cockpit: Cockpit) -> frozenset[str]:
    now = cockpit.now()
    return frozenset() if now.input is None else now.input.keys


PRESS = """
([type, options]) => document.body.dispatchEvent(
  new KeyboardEvent(type, { bubbles: true, cancelable: true, ...options }))
"""


def press(page: Page, event: str, **options: str | bool) -> None:
    """As a keyboard of another layout, or another system, has the browser say."""
    page.evaluate(PRESS, [event, options])


def test_a_release_that_macos_keeps_to_itself(cockpit, taken):
    press(taken, "keydown", code="KeyJ", key="j")
    wait_until(lambda: held(cockpit) == {"KeyJ"}, "held key", taken)
    press(taken, "keydown", code="MetaLeft", key="Meta", metaKey=True)
    wait_until(lambda: not held(cockpit), "letting go", taken)
    # The release of J is never told; nor is it pressed again by itself.
    press(taken, "keyup", code="MetaLeft", key="Meta")
    press(taken, "keydown", code="KeyJ", key="j", repeat=True)
    taken.wait_for_timeout(300)
    assert not held(cockpit)
    press(taken, "keyup", code="KeyJ", key="j")


def test_a_hidden_page_says_nothing_so_that_the_robot_holds(cockpit, taken):
    press(taken, "keydown", code="KeyJ", key="j")
    wait_until(lambda: held(cockpit) == {"KeyJ"}, "held key", taken)
    taken.evaluate(
        """() => {
          Object.defineProperty(document, "hidden", { configurable: true, get: () => true });
          document.dispatchEvent(new Event("visibilitychange"));
        }"""
    )
    wait_until(lambda: cockpit.now().must_hold, "hold", taken)
    taken.evaluate("() => delete document.hidden")
    press(taken, "keyup", code="KeyJ", key="j")
    wait_until(lambda: not cockpit.now().abandoned and not held(cockpit), "sign of life", taken)


PADS = """
({ mapping, frozen }) => {
  const pushed = { connected: true, axes: [-1, 0, 0, 0], buttons: [{ pressed: true }] };
  const dead = { ...pushed, axes: [0, 0, 0, 0], buttons: [], mapping: "standard", timestamp: 0 };
  const began = performance.now();
  navigator.getGamepads = () =>
    [dead, null, { ...pushed, mapping, timestamp: frozen ? began : performance.now() }];
}
"""
"""the stick to the left and a button held; in the first slot a device that is dead"""


def test_a_gamepad_drives_unless_it_is_unknown_or_frozen(cockpit, taken):
    def pushed() -> bool:
        pad = cockpit.latest_input.pad
        return pad is not None and pad.axes[0] == -1.0

    def says(word: str) -> bool:
        return word in taken.locator("#sheath-operator").inner_text()

    taken.evaluate(PADS, {"mapping": "standard", "frozen": False})
    wait_until(pushed, "the pad", taken)
    taken.evaluate(PADS, {"mapping": "", "frozen": False})
    wait_until(lambda: says("layout is unknown") and not pushed(), "word of the pad", taken)
    taken.evaluate(PADS, {"mapping": "standard", "frozen": True})
    wait_until(pushed, "the pad", taken)
    wait_until(lambda: says("says nothing new") and not pushed(), "word of the pad", taken)
    taken.evaluate("() => { navigator.getGamepads = () => []; }")


@pytest.mark.parametrize(
    ("layout", "code", "key"),
    [
        pytest.param("AZERTY: Z where W was", "KeyW", "z", marks=pytest.mark.soak),
        pytest.param("QWERTZ: Z where Y was", "KeyY", "z", marks=pytest.mark.soak),
        pytest.param("Caps lock", "KeyZ", "Z", marks=pytest.mark.soak),
        ("Cyrillic", "KeyZ", "я"),
    ],
)
def test_what_discards_is_the_printed_letter(cockpit, taken, layout, code, key):
    del layout
    cockpit.begin_episode()
    # Y of QWERTZ and W of AZERTY lie where Z is on an American keyboard.
    # On Dvorak's there is a semicolon.
    for other in ("y", "w", ";", "Dead", "ž"):
        press(taken, "keydown", code="KeyZ", key=other)
        press(taken, "keyup", code="KeyZ", key=other)
    taken.wait_for_timeout(200)
    assert cockpit.ending is None
    press(taken, "keydown", code=code, key=key)
    press(taken, "keyup", code=code, key=key)
    wait_until(lambda: cockpit.ending is not None, "ending", taken)
    cockpit.begin_episode()


def test_dvoraks_p_does_not_reset_the_stop(cockpit, taken):
    press(taken, "keydown", code="Space", key=" ")
    wait_until(lambda: cockpit.state.stopped, "stop", taken)
    taken.wait_for_function("sheathOperator.state.stopped")
    # P lies where R is on an American keyboard, and R where O is.
    press(taken, "keydown", code="KeyR", key="p")
    wait_until(lambda: cockpit.paused, "pause", taken)
    assert cockpit.state.stopped
    press(taken, "keydown", code="KeyO", key="r")
    wait_until(lambda: not cockpit.state.stopped, "reset", taken)


def test_what_drives_is_the_printed_letter_and_its_release_is_its_place(cockpit, taken):
    press(taken, "keydown", code="KeyC", key="j")
    wait_until(lambda: held(cockpit) == {"KeyJ"}, "held key", taken)
    # Shift came down meanwhile, or the layout was changed.
    press(taken, "keyup", code="KeyC", key="?")
    wait_until(lambda: not held(cockpit), "letting go", taken)


def luminance(rgb: str) -> float:
    """Relative, of a colour as a browser says it (WCAG 2.1)."""
    shares = [int(each) / 255 for each in rgb.removeprefix("rgb(").removesuffix(")").split(",")]
    linear = [s / 12.92 if s <= 0.04045 else ((s + 0.055) / 1.055) ** 2.4 for s in shares]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def contrast(page: Page, selector: str) -> float:
    """Of an element's letters on its ground."""
    colours = page.locator(selector).evaluate(
        "(it) => [getComputedStyle(it).color, getComputedStyle(it).backgroundColor]"
    )
    low, high = sorted(map(luminance, colours))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("size", SIZES)
def test_the_stop_is_large_always_there_and_the_first_that_tab_reaches(cockpit, taken, size):
    resize(taken, size)
    width, height = SIZES[size]
    stop = taken.get_by_role("button", name="Emergency stop")
    box, notice = stop.bounding_box(), taken.locator("#sheath-operator").bounding_box()
    assert box is not None
    assert notice is not None
    assert box["width"] >= 100
    assert box["height"] >= 60
    for each in (box, notice):
        assert each["x"] >= 0
        assert each["y"] >= 0
        assert each["x"] + each["width"] <= width
        assert each["y"] + each["height"] <= height
    assert not (
        notice["y"] + notice["height"] > box["y"]
        and notice["x"] < box["x"] + box["width"]
        and notice["y"] < box["y"] + box["height"]
    )
    assert contrast(taken, "#sheath-stop") > 4.5
    assert contrast(taken, "#sheath-operator") > 4.5
    # Nothing of viser's lies over it.
    stop.click(trial=True)
    assert taken.evaluate("document.body.firstElementChild.id") == "sheath-stop"
    press_on(taken, stop)
    wait_until(lambda: cockpit.state.stopped, "stop", taken)
    wait_until(
        lambda: taken.locator("#sheath-operator").inner_text().startswith("EMERGENCY STOP"),
        "word of the stop",
        taken,
    )
    assert contrast(taken, "#sheath-operator") > 4.5
    taken.set_viewport_size({"width": 400, "height": 300})


@pytest.mark.soak
def test_the_page_says_what_became_of_its_connection(opened, served, monkeypatch):
    notice = opened.locator("#sheath-operator")

    def says(word: str, page: Page = opened) -> None:
        wait_until(
            lambda: word in page.locator("#sheath-operator").inner_text(), f"word of {word}", page
        )

    # Nothing comes, though the connection stands.
    served._server.loop.call_soon_threadsafe(time.sleep, 3.0)
    says("CONNECTION LOST")
    assert "✕" in opened.title()
    wait_until(lambda: not notice.is_visible(), "connection", opened)

    other = opened.context.browser.new_page()  # pyright: ignore[reportOptionalMemberAccess]
    # A page that is only just built has lost nothing yet, but does not wait for ever.
    monkeypatch.setattr(served._server.operators, "serve", lambda silent: silent.wait_closed())
    open_dashboard(other, served.address)
    other.wait_for_function("window.sheathOperator")
    other.wait_for_timeout(2500)
    assert "LOST" not in other.locator("#sheath-operator").inner_text()
    says("CONNECTION LOST", other)
    monkeypatch.undo()
    other.reload()
    other.wait_for_function("window.sheathOperator?.state.operated")
    # As a run that was started anew at the same port.
    monkeypatch.setattr(AccessControl, "_has_cookie", lambda *_: False)
    for connection in list(served._server.operators._open):
        served._server.loop.call_soon_threadsafe(connection.transport.abort)
    says("ANOTHER RUN", other)
    monkeypatch.undo()
    other.close()


@pytest.mark.soak
def test_the_page_says_that_the_run_has_ended(opened, served):
    opened.reload()
    opened.wait_for_function("window.sheathOperator?.state.operated")
    # In so small a window viser's own panel is closed.
    pause = opened.get_by_role("group", name="Orders").get_by_role("button", name="Pause")
    said = opened.get_by_text("FINISHED. The run has ended, recorded in runs/<b>today</b>; you see")
    # Whatever it is called.
    served.saved_in = "runs/<b>today</b>"
    served.on_start(Corridor(), INFO)
    pause.wait_for()
    holding = threading.Thread(target=served.hold_open, daemon=True)
    holding.start()
    said.wait_for()
    pause.wait_for(state="hidden")
    assert not opened.locator("#sheath-stop").is_visible()
    # Also on a page that is opened only now.
    opened.reload()
    said.wait_for()
    served.close()
    holding.join(TIMEOUT_S)
    assert not holding.is_alive()
    opened.wait_for_timeout(2500)
    assert opened.locator("#sheath-operator").inner_text().startswith("FINISHED")
    assert opened.title() == "✓ sheath · corridor"
