"""Jobs of who looks at recordings, by keyboard alone.

The three worst moments, a mark and a clip; why the gate fired; a threshold with its predicted
effect; a grid of episodes with filters; the list of episodes and jumps in the replay.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page

from sheath_manip.dashboard import Replay
from sheath_manip.dataset.marks import Note
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Outcome
from tests.browser import await_no_serious_fault, resize
from tests.by_keyboard import AT_EACH_SIZE, open_panel, open_tab, press_on, tab_to
from tests.dashboard.wall_store import OUTCOMES, running_replay, wall_store
from tools.chromium import open_dashboard, wait_until

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> EpisodeStore:
    return wall_store(tmp_path_factory.mktemp("jobs") / "store")


@pytest.fixture(scope="module")
def replay(store: EpisodeStore) -> Iterator[Replay]:
    with running_replay(store) as page:
        yield page


@pytest.fixture(scope="module", params=AT_EACH_SIZE)
def sized(request: pytest.FixtureRequest, replay: Replay, browser_page: Page) -> Page:
    """The page of the replay, opened anew at each size."""
    resize(browser_page, request.param)
    open_dashboard(browser_page, replay.address)
    browser_page.wait_for_function("window.sheathSeek?.open && window.sheathWall")
    return browser_page


@pytest.fixture
def page(sized: Page, replay: Replay) -> Page:
    """The same page, which stands at the beginning, and nothing of it has the focus."""
    sized.evaluate("document.activeElement?.blur()")
    sized.keyboard.press("k")
    sized.keyboard.press("Home")
    player = replay.player
    wait_until(lambda: (player.now.at, player.now.playing) == (0, False), "rest", sized)
    return sized


def count_of(page: Page) -> int:
    return page.evaluate("sheathWall.count")


def test_the_three_worst_moments_a_mark_and_a_clip(
    page: Page, replay: Replay, store: EpisodeStore, tmp_path: Path
) -> None:
    player = replay.player
    page.keyboard.press("o")
    chosen = page.locator("#sheath-wall .tile[aria-selected=true]")
    for place, kind in enumerate(("failure", "stuck", "takeover in vain")):
        for _ in range(place):
            page.keyboard.press("ArrowRight")
        chosen.get_by_text(kind, exact=True).wait_for()
        page.keyboard.press("Enter")
        wait_until(lambda: not page.evaluate("sheathWall.shown"), "the replay", page)
        page.get_by_text(f"step {player.now.at + 1} of ").first.wait_for(state="attached")
        page.keyboard.press("m")
        page.locator("#sheath-note input:focus").wait_for()
        page.keyboard.type(f"worst {place}")
        page.keyboard.press("Enter")
        name = replay._catalog.source(player.now.place)[1]
        noted = Note(player.now.at, f"worst {place}")
        kept = lambda name=name, noted=noted: noted in store.marks(name).notes  # noqa: E731
        wait_until(kept, "mark in the store", page)
        page.keyboard.press("c")
        page.locator("#sheath-clip[open]").wait_for()
        if place == 0:
            with page.expect_download() as downloading:
                page.keyboard.press("Enter")
            downloading.value.save_as(tmp_path / "clip.mp4")
            assert (tmp_path / "clip.mp4").stat().st_size > 1000
            await_no_serious_fault(page)
        page.keyboard.press("Escape")
        page.locator("#sheath-clip[open]").wait_for(state="detached")
        # What has the focus in a closed dialog loses it with the next picture.
        page.wait_for_function("document.activeElement === document.body")
        # Back on the wall, at the first moment.
        page.keyboard.press("Escape")
        page.locator("#sheath-wall[open]").wait_for()
        page.keyboard.press("Home")
    page.keyboard.press("Escape")


def test_a_grid_of_episodes_with_filters(page: Page, replay: Replay) -> None:
    page.keyboard.press("o")
    wait_until(lambda: count_of(page) > len(OUTCOMES), "all moments", page)
    # A list takes the letters that its word begins with.
    tab_to(page, page.get_by_label("method"))
    page.keyboard.type("dagger")
    page.locator("#sheath-wall .tile").first.wait_for()
    tab_to(page, page.get_by_label("kind"))
    page.keyboard.type("stuck")
    wait_until(lambda: count_of(page) == 1, "the one of that kind and method", page)
    await_no_serious_fault(page)
    tab_to(page, page.locator("#sheath-wall .grid"))
    page.keyboard.press("Enter")
    stuck = [each.outcome for each in replay._catalog.summaries].index(Outcome.TIME_LIMIT)
    wait_until(lambda: replay.player.now.place == stuck, "that episode", page)
    page.keyboard.press("o")
    for name in ("method", "kind"):
        tab_to(page, page.get_by_label(name))
        page.keyboard.press("Home")
    wait_until(lambda: count_of(page) > len(OUTCOMES), "all moments again", page)
    # Out of the list, whose letters are its own, and back to the replay.
    page.keyboard.press("Escape")
    page.keyboard.press("o")
    page.locator("#sheath-wall[open]").wait_for(state="detached")


def test_one_reads_why_the_gate_fired_and_jumps_to_where(page: Page, replay: Replay) -> None:
    page.keyboard.press("ArrowDown")
    wait_until(lambda: replay.player.now.at > 0, "the next intervention", page)
    first = replay.player.now.at
    open_panel(page)
    page.get_by_text("Expert acts").first.wait_for()
    page.get_by_text("This state is unlike those that the policy was trained on").wait_for()
    open_tab(page, "Why")
    page.get_by_role("row").filter(has_text="support").wait_for()
    await_no_serious_fault(page)
    open_tab(page, "Episode")
    press_on(page, page.get_by_role("button", name="next ›").locator("visible=true"))
    wait_until(lambda: replay.player.now.at > first, "the one after it", page)


def test_another_threshold_and_what_it_would_come_to(page: Page) -> None:
    open_tab(page, "What if")
    page.get_by_text("requests a minute", exact=True).wait_for()
    share = page.get_by_role("row").filter(has_text="expert acts in").get_by_role("cell").last
    tab_to(page, page.get_by_role("slider", name="Threshold"))
    page.keyboard.press("End")
    wait_until(lambda: share.inner_text() == "100.0%", "the effect of the highest", page)
    page.keyboard.press("Home")
    wait_until(lambda: share.inner_text() == "0.0%", "the effect of the lowest", page)
    await_no_serious_fault(page)
    press_on(page, page.get_by_role("button", name="Back to what is now"))
    wait_until(lambda: share.inner_text() not in ("0.0%", "100.0%"), "what is", page)


def test_one_chooses_an_episode_from_the_list(page: Page, replay: Replay) -> None:
    before = replay.player.now.place
    open_tab(page, "Episodes")
    press_on(page, page.get_by_role("button", name="next ›").locator("visible=true"))
    after = (before + 1) % len(OUTCOMES)
    wait_until(lambda: replay.player.now.place == after, "the next episode", page)
    await_no_serious_fault(page)
