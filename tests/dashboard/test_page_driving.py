"""The page on the real driving task: what Chromium shows of a car that the expert takes over."""

import threading

import numpy as np
import pytest
from playwright.sync_api import Page

from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.widgets.cameras import Cameras
from sheath_manip.dashboard.widgets.score_plot import ScorePlot
from sheath_manip.dashboard.widgets.support_map import SupportMap
from sheath_manip.dashboard.widgets.trouble import Trouble
from sheath_manip.gates.support import SupportGate
from sheath_manip.rollout.action_noise import DisturbedExpert
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.pacing import Pacing
from sheath_manip.tasks.composer_environment import ComposerEnvironment
from sheath_manip.tasks.driving.expert import DrivingExpert
from sheath_manip.tasks.driving.task import DrivingTask, Scenario
from sheath_manip.types import EpisodeInfo, Observation, Purpose
from sheath_manip.types.samples import Samples
from tests.judging import ByObservation
from tools.chromium import TIMEOUT_S, open_dashboard, wait_until

pytestmark = pytest.mark.browser

SCENARIO = Scenario(laps=0.3)


def score(observation: Observation) -> float:
    """Outside for half a second in each one and a half."""
    return float(np.sin(2 * np.pi * observation.time_s / 1.5) + 0.5)


def drive(dashboard: Dashboard, enough: threading.Event) -> None:
    """Short episodes under a scripted gate, until there were enough."""
    environment = ComposerEnvironment(DrivingTask(SCENARIO))
    expert = CachedExpert(DrivingExpert(environment))
    pacing = Pacing()
    index = 0
    while not enough.is_set():
        info = EpisodeInfo("driving", index, Purpose.LEARNING, 10.0, method="sheath", index=index)
        rollout(
            environment,
            info,
            SupportGate(ByObservation(score), threshold=0.0),
            rng=np.random.default_rng(0),
            policy=DisturbedExpert(expert, environment.spec.action, noise=0.0),
            expert=expert,
            listeners=(dashboard, pacing),
        )
        index += 1
    environment.close()


def training_on(task: DrivingTask) -> Samples:
    """As if 300 labelled states lay around the lap."""
    along = np.linspace(0, task.track.lap_length, 300)
    poses = task.track.pose(along, np.random.default_rng(0).normal(0, 0.8, 300))
    return Samples({}, poses.astype(np.float32), np.zeros((300, 1), np.float32), np.zeros(300, int))


@pytest.mark.soak
def test_page_shows_a_drive_with_interventions(browser_page: Page) -> None:
    page, enough = browser_page, threading.Event()
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    task = DrivingTask(SCENARIO)
    with Dashboard(task.spec, port=0) as dashboard:
        widget = dashboard._page.widget
        dashboard.on_fit(training_on(task))
        run = threading.Thread(target=drive, args=(dashboard, enough), daemon=True)
        open_dashboard(page, dashboard.address)
        wait_until(lambda: dashboard._page.watched, "browser at the server", page)
        run.start()

        def interventions() -> int:
            snapshot = dashboard._latest()
            return snapshot.series.takeovers if snapshot else 0

        wait_until(lambda: interventions() > 1, "interventions", page)
        wait_until(lambda: widget(ScorePlot)._scores.visible, "scores", page)
        wait_until(lambda: widget(SupportMap)._image.visible, "support picture", page)
        wait_until(lambda: widget(Cameras)._images["overhead"].visible, "camera image", page)

        page.locator("canvas").first.wait_for()
        page.locator(".u-over").wait_for()
        page.get_by_text("What the policy sees").wait_for()
        page.get_by_role("tab", name="Support").click()
        # The support picture and the camera's image.
        page.wait_for_function(
            "[...document.images].filter(image => image.naturalWidth > 100).length >= 2"
        )
        page.get_by_role("tab", name="Run").click()
        counts = page.get_by_role("row").filter(has_text="takeovers").get_by_role("cell")
        wait_until(lambda: int(counts.nth(2).inner_text()) > 1, "count on the page", page)
        assert not widget(Trouble)._box.visible
        enough.set()
        run.join(TIMEOUT_S)
    assert not run.is_alive()
    assert not errors
