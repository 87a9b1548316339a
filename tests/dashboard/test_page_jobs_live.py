"""Jobs at the page of a run, by keyboard alone: the curves, a threshold, and through a tunnel."""

from collections.abc import Iterator
from contextlib import closing

import pytest
from playwright.sync_api import Page

from sheath_manip.learning.config import LearningPlan
from sheath_manip.types import Actor
from tests.browser import await_no_serious_fault, resize
from tests.by_keyboard import AT_EACH_SIZE, open_tab, press_on, tab_to
from tests.dashboard.endless_road import Dialled, dialled
from tests.experiments.round_results import results_of
from tests.slow_link import Tunnel
from tools.chromium import open_dashboard, wait_until

pytestmark = pytest.mark.browser
LAST_ROUND = 2
PLAN = LearningPlan().changed(
    comparison={"methods": ("dagger", "sheath"), "evaluation_episodes": 4, "final_episodes": 2},
    schedule={"rounds": LAST_ROUND, "episodes": 5},
)


@pytest.fixture(scope="module")
def run() -> Iterator[Dialled]:
    with dialled() as run:
        for rounds in results_of(PLAN).values():
            for result in rounds:
                run.dashboard.on_round(result)
        yield run


@pytest.fixture(params=AT_EACH_SIZE)
def page(request: pytest.FixtureRequest, browser_page: Page) -> Page:
    resize(browser_page, request.param)
    return browser_page


@pytest.mark.soak
def test_one_reads_the_curves_while_the_run_goes_on(run: Dialled, page: Page) -> None:
    open_dashboard(page, run.dashboard.address)
    page.wait_for_function("window.sheathHover")
    open_tab(page, "Learning")
    says = page.locator("#sheath-hover")
    tab_to(page, page.locator("[data-sheath-chart]").first)
    says.get_by_text(f"Failed while learning, round {LAST_ROUND}").wait_for()
    page.keyboard.press("ArrowLeft")
    says.get_by_text(f"Failed while learning, round {LAST_ROUND - 1}").wait_for()
    await_no_serious_fault(page)
    page.keyboard.press("Escape")
    says.wait_for(state="hidden")


@pytest.mark.soak
def test_a_threshold_is_applied_once_its_effect_was_seen(run: Dialled, page: Page) -> None:
    open_dashboard(page, run.dashboard.address)
    open_tab(page, "What if")
    share = page.get_by_role("row").filter(has_text="expert acts in").get_by_role("cell").last
    threshold, apply = (
        page.get_by_role("slider", name="Threshold"),
        page.get_by_role("button", name="Apply"),
    )
    for key, effect, actor, value in (
        ("End", "100.0%", Actor.EXPERT, 1.0),
        ("Home", "0.0%", Actor.POLICY, -1.0),
    ):
        tab_to(page, threshold)
        page.keyboard.press(key)
        wait_until(lambda effect=effect: share.inner_text() == effect, "predicted effect", page)
        assert not run.acts(actor, value)
        press_on(page, apply)
        wait_until(lambda actor=actor, value=value: run.acts(actor, value), "new threshold", page)
    await_no_serious_fault(page)


def test_a_tunnel_from_another_port_is_told_the_cure_and_one_from_the_same_is_let_in(
    run: Dialled, page: Page
) -> None:
    own = run.dashboard._server.access.port
    with closing(Tunnel(own)) as other:
        answer = page.goto(run.dashboard.address.replace(str(own), str(other.port)))
        assert answer is not None
        assert answer.status == 403
        page.get_by_text(f"on port {own}; when forwarding it, keep the port number.").wait_for()
    # A browser looks for localhost here first.
    with closing(Tunnel(own, ("::1", own))) as same:
        open_dashboard(page, run.dashboard.address.replace("127.0.0.1", "localhost"))
        assert same.used
        page.wait_for_function("window.sheathOperator?.state.operated")
        page.keyboard.press("p")
        wait_until(lambda: run.cockpit.paused, "an order through the tunnel", page)
        page.keyboard.press("p")
        wait_until(lambda: not run.cockpit.paused, "the run", page)
