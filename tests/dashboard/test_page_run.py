"""What a person does on the page of a run: another threshold, and a look back."""

import threading
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page

from sheath_manip.cockpit import Cockpit, Order
from sheath_manip.controllers.hold import Hold
from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.widgets.nu import NuSlider
from sheath_manip.dashboard.widgets.what_if import WhatIf
from sheath_manip.gates.adjustable import Adjustable, Boundary, Dial
from sheath_manip.gates.support import SupportGate
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.types import Action, Actor, EpisodeInfo, Observation, Purpose, Transition
from sheath_manip.types.operator_input import Binding
from tests.dashboard.conftest import SPEC, TOKEN, RingRoad, slider
from tests.judging import ByObservation, always
from tools.chromium import TIMEOUT_S, open_dashboard, wait_until
from tools.scripted_person import Absent

pytestmark = pytest.mark.browser


class EndlessRoad(RingRoad):
    """Until there was enough."""

    def __init__(self) -> None:
        super().__init__()
        self.enough = threading.Event()

    def step(self, action: NDArray[np.float32]) -> Transition:
        return replace(super().step(action), truncated=self.enough.is_set())


def straight_on() -> Action:
    return np.zeros(1, np.float32)


def test_the_threshold_changes_who_acts_once_it_is_applied(browser_page: Page) -> None:
    page, environment = browser_page, EndlessRoad()
    dial = Dial(Boundary(always(0.5), threshold=0.0, lowest=-1.0, highest=1.0))
    fitted: list[tuple[float, str]] = []

    def refit(nu: float) -> Boundary:
        fitted.append((nu, threading.current_thread().name))
        return Boundary(always(-2.0), threshold=-0.5, lowest=-3.0, highest=3.0)

    gate = (
        partial(WhatIf, dial=dial),
        partial(NuSlider, dial=dial, refit=refit, nu=0.1),
    )
    info = EpisodeInfo(SPEC.name, 1, Purpose.LEARNING, SPEC.control_rate_hz, method="sheath")
    cockpit = Cockpit((Binding(("KeyI",), "on"),))
    with Dashboard(SPEC, port=0, token=TOKEN, cockpit=cockpit, gate=gate) as dashboard:

        def run_episode() -> None:
            rollout(
                environment,
                info,
                Adjustable(SupportGate(always(0.5), 0.0), dial),
                rng=np.random.default_rng(0),
                policy=Absent(straight_on),
                expert=Hold(straight_on),
                listeners=(dashboard, Pacing()),
            )

        def acts(actor: Actor, threshold: float) -> bool:
            snapshot = dashboard._latest()
            decision = snapshot.step.decision if snapshot and snapshot.step else None
            return decision is not None and (decision.actor, decision.threshold) == (
                actor,
                threshold,
            )

        run = threading.Thread(target=run_episode, daemon=True)
        run.start()
        open_dashboard(page, dashboard.address)
        page.get_by_role("tab", name="What if").click()
        wait_until(lambda: acts(Actor.POLICY, 0.0), "policy", page)
        slider(page, 0).press("End")
        page.get_by_text("100.0%").wait_for()
        assert acts(Actor.POLICY, 0.0), "a preview moves nothing"
        apply = page.get_by_role("button", name="Apply")
        apply.click()
        wait_until(lambda: acts(Actor.EXPERT, 1.0), "expert after the threshold rose", page)
        page.get_by_text("Expert acts").wait_for()
        # While somebody drives, who watches moves nothing.
        assert cockpit.order(Order.TAKE_OVER, "somebody")
        slider(page, 0).press("Home")
        apply.click()
        page.wait_for_timeout(300)
        assert acts(Actor.EXPERT, 1.0)
        assert cockpit.order(Order.HAND_BACK, "somebody")
        apply.click()
        wait_until(lambda: acts(Actor.POLICY, -1.0), "policy after the threshold fell", page)
        slider(page, 3).press("ArrowRight")
        wait_until(lambda: acts(Actor.EXPERT, -0.5), "the refitted support's gate", page)
        assert fitted == [(pytest.approx(0.105), "support refit")]
        environment.enough.set()
        run.join(TIMEOUT_S)
    assert not run.is_alive()


@pytest.mark.soak
def test_one_looks_back_while_the_run_goes_on(browser_page: Page) -> None:
    page, environment = browser_page, EndlessRoad()
    info = EpisodeInfo(SPEC.name, 1, Purpose.LEARNING, SPEC.control_rate_hz, method="sheath")

    def score(observation: Observation) -> float:
        return float(np.sin(3 * observation.time_s))

    with Dashboard(SPEC, port=0, token=TOKEN) as dashboard:

        def run_episode() -> None:
            rollout(
                environment,
                info,
                SupportGate(ByObservation(score), 0.0),
                rng=np.random.default_rng(0),
                policy=Absent(straight_on),
                expert=Hold(straight_on),
                listeners=(dashboard, Pacing()),
            )

        def shown() -> tuple[int, bool]:
            snapshot = dashboard._latest()
            return (-1, True) if snapshot is None else (snapshot.at, snapshot.present)

        run = threading.Thread(target=run_episode, daemon=True)
        run.start()
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
        environment.enough.set()
        run.join(TIMEOUT_S)
    assert not run.is_alive()
