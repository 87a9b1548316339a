"""A person at the page in Chromium: what the robot did is asserted first, the page second."""

import math
import os
import signal
import time
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page

from sheath_manip.cockpit import Order
from sheath_manip.cockpit.shown import Shown
from sheath_manip.dashboard.widgets.tool_gizmo import SHARE_OF_VIEW
from sheath_manip.types import Actor, Reason
from tests.by_keyboard import hold_until
from tests.cockpit.operated_grasp import OperatedGrasp, operated_grasp
from tests.waiting import eventually
from tools.chromium import CHROMIUM, FLAGS, open_dashboard, wait_until
from tools.station import Station

ARROW_M = SHARE_OF_VIEW * 0.55  # of the size of what the task first shows around the tool
pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def running() -> Iterator[OperatedGrasp]:
    with operated_grasp() as grasp:
        yield grasp


@pytest.fixture(scope="module")
def opened(running, browser_page) -> Page:
    open_dashboard(browser_page, running.page.address)
    browser_page.wait_for_selector("canvas")
    browser_page.get_by_role("alert").get_by_role("button").click()
    browser_page.get_by_role("button", name="Take over (T)").wait_for()
    browser_page.wait_for_function("window.sheathOperator?.state.operated")
    return browser_page


@pytest.fixture
def grasp(running, opened) -> Iterator[OperatedGrasp]:
    """The robot inside the support, in the policy's hands, and not stopped."""
    yield running
    opened.keyboard.up("i")
    running.inside = True
    cockpit = running.cockpit
    cockpit.order(Order.RESET, "the test", shown=Shown(stops=cockpit.state.stops))
    cockpit.resume()
    # Also where who drove has left without handing back.
    holder = cockpit.lease.holder or "the test"
    cockpit.order(Order.TAKE_OVER, holder)
    cockpit.order(Order.HAND_BACK, holder)
    running.until_turn(Actor.POLICY)


def moved_m(grasp: OperatedGrasp, page: Page, key: str, least_m: float) -> NDArray:
    """(3,) how the tool moves by a key that is held, once it is `least_m` away."""
    from_m = grasp.tool_m.copy()
    hold_until(page, key, lambda: math.dist(grasp.tool_m, from_m) > least_m, "motion")
    return grasp.tool_m - from_m


def holds(grasp: OperatedGrasp, page: Page) -> None:
    """Wait until the tool stands."""

    def stands() -> bool:
        return all(
            np.abs(step.executed[:6]).max() < 0.02 and step.label is None
            for step in grasp.steps[-4:]
        )

    wait_until(stands, "standing still", page)


def test_take_over_by_click_drive_with_held_keys_and_hand_back(grasp, opened):
    page = opened
    page.get_by_role("button", name="Take over (T)").click()
    wait_until(lambda: grasp.cockpit.state.taken, "takeover", page)
    page.get_by_role("button", name="Hand back (H)").wait_for()
    # Nothing is held yet.
    holds(grasp, page)
    camera = next(iter(grasp.page._server.viser.get_clients().values())).camera
    before = camera.position.copy()
    way_m = moved_m(grasp, page, "i", 0.05)
    assert way_m[0] > 0.9 * np.linalg.norm(way_m)
    driven = next(step for step in reversed(grasp.steps) if step.label is not None)
    assert driven.decision.actor is Actor.OPERATOR
    assert driven.decision.reason is Reason.PERSON
    assert driven.label[0] == pytest.approx(0.6)
    page.keyboard.up("i")
    holds(grasp, page)
    assert moved_m(grasp, page, "k", 0.03)[0] < 0
    page.keyboard.up("k")
    np.testing.assert_array_equal(camera.position, before)
    page.get_by_role("button", name="Hand back (H)").click()
    grasp.until_turn(Actor.POLICY)
    page.get_by_role("button", name="Take over (T)").wait_for()


def test_take_over_and_hand_back_by_hotkey(grasp, opened):
    opened.keyboard.press("t")
    wait_until(lambda: grasp.cockpit.state.taken, "takeover", opened)
    opened.get_by_text("H hands back").first.wait_for()
    opened.keyboard.press("h")
    grasp.until_turn(Actor.POLICY)


def test_the_gizmo_drags_the_arm(grasp, opened):
    page = opened
    page.keyboard.press("t")
    wait_until(lambda: grasp.cockpit.state.taken, "takeover", page)
    page.wait_for_timeout(1500)
    camera = next(iter(grasp.page._server.viser.get_clients().values())).camera
    pose = grasp.cockpit.tool_pose
    assert pose is not None
    # The head of the arrow along the tool's second axis, which lies across the table: nearer to the
    # middle the arcs for turning may lie before it.
    across = rotation_of(pose[3:])[:, 1]
    start = pixel_of(camera, pose[:3] + 0.95 * ARROW_M * across)
    end = pixel_of(camera, pose[:3] + (0.95 * ARROW_M + 0.1) * across)
    from_m = grasp.tool_m.copy()
    page.mouse.move(*start)
    page.wait_for_timeout(300)
    page.mouse.down()
    page.mouse.move(*((start + end) / 2), steps=4)
    page.mouse.move(*end, steps=4)
    wait_until(lambda: math.dist(grasp.tool_m, from_m) > 0.03, "motion", page)
    way_m = grasp.tool_m - from_m
    assert way_m @ across > 0.9 * np.linalg.norm(way_m)
    assert any(step.decision.reason is Reason.PERSON for step in grasp.steps[-20:])
    page.mouse.up()
    holds(grasp, page)


def rotation_of(wxyz: NDArray) -> NDArray:
    w, x, y, z = wxyz
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def pixel_of(camera, point_m: NDArray) -> NDArray:
    """(2,) where the browser shows a point (viser's cameras: x right, y down, z forward)."""
    seen = rotation_of(camera.wxyz).T @ (point_m - camera.position)
    height, width = camera.image_height, camera.image_width
    focal = height / 2 / np.tan(camera.fov / 2)
    return np.array([width / 2, height / 2]) + focal * seen[:2] / seen[2]


def test_the_stop_is_latched_until_it_is_reset(grasp, opened):
    page = opened
    page.keyboard.press("t")
    wait_until(lambda: grasp.cockpit.state.taken, "takeover", page)
    moved_m(grasp, page, "j", 0.02)
    # Also where the focus is in a field.
    page.get_by_role("textbox").first.focus()
    page.keyboard.press("Space")
    wait_until(lambda: grasp.cockpit.state.stopped, "stop", page)
    stopped = Reason.EMERGENCY_STOP
    wait_until(lambda: grasp.steps[-1].decision.reason is stopped, "hold by the stop", page)
    holds(grasp, page)
    # Still held, and still stopped.
    page.get_by_text("EMERGENCY STOP. R resets it.").wait_for()
    page.keyboard.up("j")
    # In a field an h is a letter.
    page.evaluate("document.activeElement.blur()")
    page.keyboard.press("h")
    page.wait_for_timeout(300)
    assert grasp.cockpit.state.stopped
    page.get_by_role("button", name="Reset the stop (R)").click()
    wait_until(lambda: not grasp.cockpit.state.stopped, "reset", page)
    # It moves only once it is told to.
    wait_until(lambda: grasp.cockpit.paused, "pause", page)
    page.get_by_role("button", name="Resume (P)").click()
    grasp.until_turn(Actor.POLICY)
    page.get_by_role("button", name="STOP (Space)").click()
    wait_until(lambda: grasp.cockpit.state.stopped, "stop by click", page)
    holds(grasp, page)


def test_the_gate_asks_and_the_person_answers(grasp, opened):
    page = opened
    heard = page.evaluate("sheathOperator.beeps")
    grasp.inside = False
    page.get_by_text("The robot holds and asks for you").wait_for()
    page.get_by_text("Robot holds", exact=True).wait_for()
    assert grasp.steps[-1].decision.reason is Reason.WAITING
    page.wait_for_function(f"sheathOperator.beeps > {heard}")
    page.keyboard.press("t")
    assert moved_m(grasp, page, "u", 0.02)[2] > 0.01
    page.get_by_text("Operator acts").wait_for()
    page.keyboard.up("u")
    grasp.inside = True
    page.keyboard.press("h")
    grasp.until_turn(Actor.POLICY)


PUSHED = """
() => {
  const buttons = [...Array(17).keys()].map((n) => ({ pressed: n === 4 }));
  const pad = { connected: true, mapping: "standard", axes: [-1, 0, 0, 0], buttons };
  navigator.getGamepads = () => [null, { ...pad, timestamp: performance.now() }];
}
"""
"""the left stick to the left, the left shoulder button held"""


def test_a_gamepad_drives_the_arm(grasp, opened):
    opened.keyboard.press("t")
    wait_until(lambda: grasp.cockpit.state.taken, "takeover", opened)
    from_m = grasp.tool_m.copy()
    opened.evaluate(PUSHED)
    wait_until(lambda: math.dist(grasp.tool_m, from_m) > 0.03, "motion", opened)
    way_m = grasp.tool_m - from_m
    assert way_m[1] > 0.9 * np.linalg.norm(way_m)
    opened.evaluate("() => { navigator.getGamepads = () => []; }")
    holds(grasp, opened)


def test_pause_step_and_speed(grasp, opened):
    page = opened
    page.keyboard.press("p")
    wait_until(lambda: grasp.cockpit.paused, "pause", page)
    page.wait_for_timeout(300)
    done = len(grasp.steps)
    page.get_by_role("button", name="One step (.)").click()
    wait_until(lambda: len(grasp.steps) == done + 1, "step", page)
    page.keyboard.press(".")
    wait_until(lambda: len(grasp.steps) == done + 2, "step by hotkey", page)
    page.keyboard.press("p")
    wait_until(lambda: len(grasp.steps) > done + 4, "steps", page)
    slider = page.get_by_role("slider").first
    slider.focus()
    slider.press("End")
    wait_until(lambda: grasp.cockpit.speed == 4.0, "speed", page)
    slider.press("Home")
    wait_until(lambda: grasp.cockpit.speed == 0.1, "speed", page)
    grasp.cockpit.order(Order.SPEED, "the test", 1.0)


def test_two_cannot_both_drive(grasp, opened):
    # The first is a program: two pages that draw in software starve each other.
    with Station(grasp.page.address) as first:
        first.order("take-over")
        # Up and away: down among the objects one topples, and a slow page finds the episode over.
        first.hold(keys=["KeyU"])
        grasp.until_turn(Actor.OPERATOR)
        holder = grasp.cockpit.lease.holder
        opened.get_by_text("Another page drives").wait_for()
        opened.keyboard.press("t")
        opened.get_by_role("button", name="Hand back (H)").click()
        opened.keyboard.down("j")
        opened.wait_for_timeout(500)
        opened.keyboard.up("j")
        assert grasp.cockpit.lease.holder == holder
        assert grasp.cockpit.input.keys == {"KeyU"}
        # But the stop is everybody's.
        opened.keyboard.press("Space")
        wait_until(lambda: grasp.cockpit.state.stopped, "stop", opened)


@pytest.mark.soak
def test_a_killed_browser_leaves_the_robot_holding_within_half_a_second(grasp, opened):
    own = opened.context.browser
    assert own is not None
    doomed = own.browser_type.launch(executable_path=CHROMIUM, args=FLAGS)
    # Two browsers draw at once, and what is drawn too late makes the robot hold: a small window.
    page = doomed.new_page(viewport={"width": 480, "height": 320})
    open_dashboard(page, grasp.page.address)
    page.wait_for_function("window.sheathOperator?.state.operated")
    page.keyboard.press("t")
    page.wait_for_function("window.sheathOperator.state.mine")
    page.keyboard.down("l")
    grasp.until_turn(Actor.OPERATOR)
    processes = doomed.new_browser_cdp_session().send("SystemInfo.getProcessInfo")["processInfo"]
    killed_s = time.monotonic()
    for process in processes:
        os.kill(process["id"], signal.SIGKILL)
    assert eventually(lambda: grasp.turns[-1][1] is Actor.HOLD)
    assert max(at_s for at_s, turn in grasp.turns if turn is Actor.OPERATOR) - killed_s < 0.5
    holds(grasp, opened)
    # The policy does not go on where a person had thought it wrong; somebody must say so.
    assert eventually(lambda: grasp.cockpit.lease.holder is None)
    opened.get_by_text("H lets the policy go on").first.wait_for()
    opened.keyboard.press("h")
    grasp.until_turn(Actor.POLICY)
