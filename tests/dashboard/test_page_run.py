"""What a person does on the page of a run: another threshold, and a look back."""

import numpy as np
import pytest
from playwright.sync_api import Page

from sheath_manip.cockpit import Order
from sheath_manip.dashboard import Dashboard
from sheath_manip.gates.support import SupportGate
from sheath_manip.types import Actor, Observation
from tests.dashboard.conftest import SPEC, TOKEN, slider
from tests.dashboard.endless_road import dialled, driven
from tests.judging import ByObservation
from tools.chromium import open_dashboard, wait_until

pytestmark = pytest.mark.browser


def test_the_threshold_changes_who_acts_once_it_is_applied(browser_page: Page) -> None:
    page = browser_page
    with dialled() as run:
        open_dashboard(page, run.dashboard.address)
        page.get_by_role("tab", name="What if").click()
        wait_until(lambda: run.acts(Actor.POLICY, 0.0), "policy", page)
        slider(page, 0).press("End")
        page.get_by_text("100.0%").wait_for()
        assert run.acts(Actor.POLICY, 0.0), "a preview moves nothing"
        apply = page.get_by_role("button", name="Apply")
        apply.click()
        wait_until(lambda: run.acts(Actor.EXPERT, 1.0), "expert after the threshold rose", page)
        page.get_by_text("Expert acts", exact=True).wait_for()
        # While somebody drives, who watches moves nothing.
        assert run.cockpit.order(Order.TAKE_OVER, "somebody")
        slider(page, 0).press("Home")
        apply.click()
        page.wait_for_timeout(300)
        assert run.acts(Actor.EXPERT, 1.0)
        assert run.cockpit.order(Order.HAND_BACK, "somebody")

        def fell() -> bool:
            if run.acts(Actor.POLICY, -1.0):
                return True
            # The dial is drawn anew as the run goes on, and a key or a click may meet the old one.
            slider(page, 0).press("Home")
            apply.click()
            return False

        wait_until(fell, "policy after the threshold fell", page)
        slider(page, 3).press("ArrowRight")
        wait_until(lambda: run.acts(Actor.EXPERT, -0.5), "the refitted support's gate", page)
        assert run.fitted == [(pytest.approx(0.105), "support refit")]


@pytest.mark.soak
def test_one_looks_back_while_the_run_goes_on(browser_page: Page) -> None:
    page = browser_page

    def score(observation: Observation) -> float:
        return float(np.sin(3 * observation.time_s))

    with (
        Dashboard(SPEC, port=0, token=TOKEN) as dashboard,
        driven(dashboard, SupportGate(ByObservation(score), 0.0)),
    ):

        def shown() -> tuple[int, bool]:
            snapshot = dashboard._latest()
            return (-1, True) if snapshot is None else (snapshot.at, snapshot.present)

        open_dashboard(page, dashboard.address)
        wait_until(lambda: shown()[0] > 60, "steps", page)
        page.get_by_role("button", name="‹ before").click()
        wait_until(lambda: not shown()[1], "look back", page)
        snapshot = dashboard._latest()
        assert snapshot is not None
        assert snapshot.at in [start for start, _ in snapshot.trace.turns]
        wait_until(lambda: len(dashboard._film or ()) > snapshot.at + 40, "run going on", page)
        assert shown() == (snapshot.at, False)
        page.get_by_role("button", name="Back to the present").click()
        wait_until(lambda: shown()[1], "the present", page)
        assert shown()[0] > snapshot.at + 30
