"""The learning tab in Chromium: the numbers of a round for pointer, finger, keyboard and reader."""

import re
from collections.abc import Iterator

import pytest
from playwright.sync_api import Locator, Page

from sheath_manip.dashboard import Dashboard
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.results import RoundResult
from sheath_manip.types import EpisodeInfo, Purpose
from sheath_manip.types.work import Headway, Work
from tests.browser import await_no_serious_fault
from tests.dashboard.conftest import SPEC, RingRoad
from tests.experiments.round_results import TRAITS, results_of
from tools.chromium import open_dashboard, wait_until

pytestmark = pytest.mark.browser

MARKUP = "<b>mine</b>"
PLAN = LearningPlan().changed(
    comparison={
        "methods": ("dagger", "sheath", MARKUP),
        "evaluation_episodes": 4,
        "final_episodes": 2,
    },
    schedule={"rounds": 4, "episodes": 5},
)


@pytest.fixture
def results(monkeypatch: pytest.MonkeyPatch) -> list[RoundResult]:
    monkeypatch.setitem(TRAITS, MARKUP, (0.3, 0.2))
    return [result for rounds in results_of(PLAN).values() for result in rounds]


@pytest.fixture
def opened(dashboard: Dashboard, browser_page: Page, results: list[RoundResult]) -> Iterator[Page]:
    """The tab, with all rounds but the last one of each method."""
    page, environment = browser_page, RingRoad()
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    for result in results:
        if result.round < PLAN.schedule.rounds:
            dashboard.on_round(result)
    dashboard.on_headway(Headway(30, 120, 725.0))
    info = EpisodeInfo(SPEC.name, 1, Purpose.LEARNING, 20.0, method="dagger", round=4, run_seed=2)
    dashboard.on_start(environment, info)
    open_dashboard(page, dashboard.address)
    page.get_by_role("tab", name="Learning").click()
    page.wait_for_function("window.sheathHover")
    charts(page).first.wait_for()
    yield page
    assert not errors


def charts(page: Page) -> Locator:
    return page.locator("[data-sheath-chart]")


def box(page: Page) -> Locator:
    return page.locator("#sheath-hover")


def says(page: Page, words: str) -> None:
    wait_until(lambda: words in (box(page).text_content() or ""), f"box with {words!r}", page)
    box(page).wait_for(state="visible")


def gone(page: Page) -> None:
    box(page).wait_for(state="hidden")


def point_at(page: Page, share: float) -> None:
    """Move the pointer so far across the first chart, which may be drawn anew meanwhile."""
    chart = charts(page).first
    chart.scroll_into_view_if_needed()
    chart.hover(position={"x": share * chart.evaluate("(it) => it.clientWidth"), "y": 40})


def test_the_numbers_of_a_round_are_shown(opened: Page, dashboard: Dashboard, results) -> None:
    page = opened
    page.get_by_text("DAgger, training seed 2, round 4").wait_for()
    page.get_by_text("30 of 120 episodes and fits · about 12 min left").wait_for()
    dashboard.on_work(Work("fitting round 4"))
    page.get_by_text("DAgger, training seed 2, round 4: fitting round 4").wait_for()

    point_at(page, 0.97)
    says(page, "Failed while learning, round 3")
    said = box(page).text_content() or ""
    for words in ("DAgger", "SHEATH", MARKUP):
        assert words in said
    assert len(re.findall(r"\(\d+–\d+ %\), 15 episodes", said)) == 3
    assert len(re.findall(r"0: [\d.]+ % · 1: [\d.]+ % · 2: [\d.]+ %", said)) == 3
    # A name that looks like markup is text, in the box and below the chart.
    assert page.locator("b", has_text="mine").count() == 0
    inside = box(page).bounding_box()
    assert inside is not None
    assert inside["x"] >= 0
    assert inside["x"] + inside["width"] <= 1400
    point_at(page, 0.15)
    says(page, "Failed while learning, round 0")
    page.mouse.move(300, 500)
    gone(page)

    charts(page).nth(1).focus()
    says(page, "Succeeded while learning, round 3")
    for key, number in (("ArrowLeft", 2), ("Home", 0), ("ArrowLeft", 0), ("End", 3)):
        page.keyboard.press(key)
        says(page, f"Succeeded while learning, round {number}")
    # A new round draws the charts anew: who reads the numbers goes on where that was.
    for result in results:
        if result.round == PLAN.schedule.rounds:
            dashboard.on_round(result)
    rounds = charts(page).nth(1).locator("template")
    wait_until(lambda: rounds.count() == 5, "new round", page)
    says(page, "Succeeded while learning, round 3")
    page.keyboard.press("ArrowRight")
    says(page, "Succeeded while learning, round 4")
    page.keyboard.press("Escape")
    gone(page)


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_nothing_hinders_eyes_and_screen_readers_at_the_curves(opened: Page, dark: bool) -> None:
    page = opened
    page.emulate_media(color_scheme="dark" if dark else "light")
    page.locator(f"html[data-mantine-color-scheme={'dark' if dark else 'light'}]").wait_for()
    charts(page).first.focus()
    says(page, "round 3")
    await_no_serious_fault(page)
