"""The wall of moments, in Chromium: by keyboard alone, on a desk and a phone, and with many."""

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page

from sheath_manip.dashboard import Replay
from sheath_manip.dataset.store import EpisodeStore
from tests.browser import SIZES, await_no_serious_fault, resize
from tests.dashboard.wall_store import NOTE, STEPS, running_replay, wall_store
from tools.bench_wall import FILTER_S, PAINT_S, filter_s, nothing_to_see, paint_s
from tools.chromium import TIMEOUT_S, chromium_page, drawn_width, open_dashboard, wait_until
from tools.synthetic_store import SyntheticStore

pytestmark = pytest.mark.browser


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> EpisodeStore:
    return wall_store(tmp_path_factory.mktemp("wall") / "store")


@pytest.fixture(scope="module")
def replay(store: EpisodeStore) -> Iterator[Replay]:
    with running_replay(store) as page:
        yield page


@pytest.fixture(scope="module")
def opened(replay: Replay) -> Iterator[Page]:
    with chromium_page() as page:
        open_dashboard(page, replay.address)
        page.wait_for_function("window.sheathSeek?.open && window.sheathWall")
        yield page


def count_of(page: Page) -> int:
    return page.evaluate("sheathWall.count")


def test_the_keyboard_alone_finds_opens_and_takes_a_moment(
    opened: Page, replay: Replay, tmp_path: Path
) -> None:
    page, player = opened, replay.player
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.keyboard.press("o")
    page.locator("#sheath-wall .tile img").first.wait_for()
    wait_until(lambda: count_of(page) == 11, "all moments", page)
    kinds = page.locator("#sheath-wall .kind").all_inner_texts()
    assert kinds[:2] == ["failure", "stuck"]
    # A note is text, whatever it looks like.
    page.get_by_text(NOTE).wait_for()
    assert page.locator("#sheath-wall b").count() == 0

    # The end of the second episode.
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    there = lambda: (player.now.place, player.now.at, player.now.playing)  # noqa: E731
    second = next(
        place
        for place, each in enumerate(replay._catalog.summaries)
        if each.outcome == "time-limit"
    )
    wait_until(lambda: there() == (second, STEPS - 1, False), "that moment", page)
    assert not page.evaluate("sheathWall.shown")
    page.get_by_text(f"step {STEPS} of {STEPS}").wait_for()

    # Back to where one was; what moves in time is not moved behind the wall.
    page.keyboard.press("Escape")
    page.locator("#sheath-wall[open]").wait_for()
    page.locator("#sheath-wall .tile[aria-selected=true]").get_by_text("stuck").wait_for()
    page.keyboard.press("Home")
    page.keyboard.press("l")
    page.wait_for_timeout(300)
    assert there() == (second, STEPS - 1, False)

    page.keyboard.press("/")
    page.keyboard.type("slips sheath")
    wait_until(lambda: count_of(page) == 0, "nothing of both words", page)
    page.keyboard.press("Control+a")
    page.keyboard.type("SLIPS")
    wait_until(lambda: count_of(page) == 1, "the note", page)
    page.keyboard.press("Enter")
    page.keyboard.press("c")
    page.get_by_role("heading", name=f"Clip around step 6 of {STEPS}").wait_for()
    page.get_by_label("to step").fill("12")
    for kind in ("mp4", "gif"):
        with page.expect_download() as downloading:
            page.get_by_role("button", name=kind, exact=True).press("Enter")
        assert downloading.value.suggested_filename.endswith(f"steps-1-12.{kind}")
        downloading.value.save_as(tmp_path / kind)
        assert (tmp_path / kind).stat().st_size > 1000
    page.get_by_label("to step").fill("0")
    page.keyboard.press("Escape")
    page.keyboard.press("/")
    page.keyboard.press("Delete")
    page.keyboard.press("Escape")
    page.keyboard.press("Escape")
    wait_until(lambda: not page.evaluate("sheathWall.shown"), "the replay", page)
    # In the replay the clip is of the step that is shown.
    page.keyboard.press("c")
    page.get_by_role("heading", name=f"Clip around step {STEPS} of {STEPS}").wait_for()
    page.keyboard.press("Escape")
    assert not errors


def test_filters_and_the_pointer(opened: Page, replay: Replay) -> None:
    page = opened
    page.get_by_role("button", name="Moments (O)").click()
    page.get_by_label("kind").select_option("takeover in vain")
    wait_until(lambda: count_of(page) == 2, "takeovers in vain", page)
    page.get_by_label("method").select_option("sheath")
    wait_until(lambda: count_of(page) == 1, "those of one method", page)
    tile = page.locator("#sheath-wall .tile")
    image = tile.locator("img")
    image.wait_for()
    still = image.get_attribute("style")
    tile.hover()
    wait_until(lambda: image.get_attribute("style") != still, "moving picture", page)
    tile.click()
    wait_until(lambda: not page.evaluate("sheathWall.shown"), "the replay", page)
    wait_until(lambda: not replay.player.now.playing, "that moment", page)
    page.keyboard.press("o")
    for name in ("kind", "method"):
        page.get_by_label(name).select_option("")
    wait_until(lambda: count_of(page) == 11, "all moments", page)
    page.keyboard.press("o")


@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
@pytest.mark.parametrize("size", SIZES)
def test_nothing_hinders_eyes_and_screen_readers(opened: Page, size: str, dark: bool) -> None:
    page = opened
    page.emulate_media(color_scheme="dark" if dark else "light")
    resize(page, size)
    page.keyboard.press("o")
    page.locator("#sheath-wall .tile img").first.wait_for()
    for overlay in ("#sheath-wall", "#sheath-clip"):
        if overlay == "#sheath-clip":
            page.keyboard.press("c")
        page.locator(f"{overlay}[open]").wait_for()
        await_no_serious_fault(page)
        # Nothing lies beyond the window's edge.
        assert page.evaluate("document.documentElement.scrollWidth") <= SIZES[size][0]
    assert drawn_width(page.locator("#sheath-wall .tile").first, page) >= 150
    page.keyboard.press("Escape")
    page.keyboard.press("o")


@pytest.mark.soak
def test_ten_thousand_episodes_are_on_the_wall_at_once(opened: Page) -> None:
    page = opened
    resize(page, "desk")
    with nothing_to_see(SyntheticStore(10_000)) as many:
        run = threading.Thread(target=many.run, args=(0,), daemon=True)
        run.start()
        open_dashboard(page, many.address)
        page.wait_for_function("window.sheathWall")
        wait_until(lambda: many._wall._shelf._read == 10_000, "moments", page)
        assert paint_s(page) <= PAINT_S
        assert count_of(page) > 30_000
        # Of all those tiles the ones in sight are there.
        assert page.locator("#sheath-wall .tile").count() < 100
        assert filter_s(page) <= FILTER_S
        page.keyboard.press("End")
        page.locator("#sheath-wall .tile[aria-selected=true]").wait_for()
    run.join(TIMEOUT_S)
    assert not run.is_alive()
