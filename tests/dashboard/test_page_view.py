"""What a person does on the pages with a mouse and the arrow keys, in one Chromium."""

import threading
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import pytest
from playwright.sync_api import Page

from sheath_manip.dashboard import Replay
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dataset.marks import Marks, Note
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.playback.clip import clip
from sheath_manip.playback.film import film_of
from sheath_manip.playback.making import exported
from sheath_manip.types import Outcome
from tests.dashboard.conftest import SPEC, TOKEN, RingRoad, drive, slider
from tools.chromium import TIMEOUT_S, drawn_width, open_dashboard, wait_until

pytestmark = pytest.mark.browser


STEPS = 60
"""of each episode: all of them are encoded for the export"""


@pytest.fixture
def store(tmp_path: Path) -> EpisodeStore:
    store = EpisodeStore.create(tmp_path / "store")
    for index in range(2):
        episode = drive(RingRoad(), STEPS)
        store.append(replace(episode, info=replace(episode.info, index=index)))
    return store


@pytest.fixture
def replay(store: EpisodeStore) -> Iterator[Replay]:
    catalog, environment = EpisodeCatalog(store), RingRoad()

    def film_at(place: int):
        return film_of(environment, catalog.read(place))

    with Replay(
        SPEC,
        catalog,
        film_at,
        lambda place, kind: exported(film_at(place), None, kind),
        lambda place, *rest: clip(film_at(place), None, *rest),
        port=0,
        token=TOKEN,
    ) as page:
        run = threading.Thread(target=page.run, args=(0,), daemon=True)
        run.start()
        yield page
    run.join(TIMEOUT_S)
    assert not run.is_alive()


def test_replay_scrubs_jumps_marks_and_exports(
    browser_page: Page, replay: Replay, store: EpisodeStore, tmp_path: Path
) -> None:
    page, player = browser_page, replay.player
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    open_dashboard(page, replay.address)
    # It plays by itself.
    wait_until(lambda: player.now.at > 3, "moving replay", page)
    page.get_by_text("Policy acts").or_(page.get_by_text("Expert acts")).first.wait_for()

    def scrubbed(key: str, step: int) -> bool:
        if (player.now.at, player.now.playing) == (step, False):
            return True
        # While it plays the slider is drawn anew all the time, and a key may meet the old one.
        slider(page, 0).press(key)
        return False

    wait_until(partial(scrubbed, "End", STEPS - 1), "scrubbing", page)
    page.get_by_text("episode over").wait_for()
    page.get_by_text(f"step {STEPS} of {STEPS}").wait_for()
    reads = partial(slider(page, 0).get_attribute, "aria-valuenow")
    wait_until(lambda: reads() == str(STEPS), "slider at the end", page, 5.0)
    wait_until(partial(scrubbed, "Home", 0), "scrubbing back", page)
    page.get_by_text(f"step 1 of {STEPS}").wait_for()
    wait_until(lambda: reads() == "1", "slider at the beginning", page)
    # Nothing of it is the present, which could be late, or be paused.
    page.keyboard.press("p")
    page.wait_for_timeout(300)
    assert not page.locator("#sheath-operator").is_visible()
    assert not replay._server.operators._pictures

    film = player.now.film
    assert film is not None
    starts = [start for start, _ in film.trace.so_far().turns]
    first_later = next(start for start in starts if start > 0)
    page.get_by_role("button", name="next ›").click()
    wait_until(lambda: player.now.at == first_later, "jump to an intervention", page)
    page.get_by_text("Expert acts").wait_for()

    page.get_by_role("tab", name="Marks").click()
    page.get_by_role("button", name="begins here").click()
    page.get_by_role("button", name="10 »").click()
    wait_until(lambda: player.now.at == first_later + 10, "ten steps on", page)
    page.get_by_role("button", name="ends here").click()
    name = store.names()[0]
    bad = ((first_later, first_later + 11),)
    wait_until(lambda: store.marks(name).bad == bad, "mark in the store", page)
    page.get_by_role("combobox", name="Outcome").click()
    page.get_by_role("option", name="failure").click()
    wait_until(lambda: store.marks(name) == Marks(Outcome.FAILURE, bad), "outcome", page)

    with page.expect_download() as downloading:
        page.get_by_role("button", name="html").click()
    saved = tmp_path / "episode.html"
    downloading.value.save_as(saved)
    assert downloading.value.suggested_filename == f"{name}.html"

    page.get_by_role("tab", name="Episodes").click()
    page.get_by_role("button", name="next ›").locator("visible=true").last.click()
    wait_until(lambda: player.now.place == 1, "the other episode", page)
    assert not errors

    # The live page builds its workers from blobs until it is left, and they are not the file's.
    page.goto("about:blank")
    requests: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.goto(saved.as_uri())
    # Not wait_for_function, whose second look is an eval, which the page's own policy forbids.
    video = page.locator("#film")
    wait_until(lambda: video.evaluate("film => film.readyState") >= 2, "film", page)
    assert page.locator("#turns button").count() == len(starts)
    page.locator("#turns button").nth(starts.index(first_later)).click()
    scrub = page.locator("#scrub")
    wait_until(lambda: scrub.input_value() == str(first_later), "jump", page)
    assert not errors
    assert {url.partition(":")[0] for url in requests} <= {"file", "data"}
    # A name that looks like markup is text there, too.
    assert page.locator("b").count() == 0


def test_clicks_and_keys_move_in_time(
    browser_page: Page, replay: Replay, store: EpisodeStore
) -> None:
    page, player = browser_page, replay.player
    open_dashboard(page, replay.address)
    page.wait_for_function("window.sheathSeek?.open")
    page.get_by_text("who acted and why").wait_for()

    def at(step: int, what: str, playing: bool = False) -> None:
        there = lambda: (player.now.at, player.now.playing) == (step, playing)  # noqa: E731
        wait_until(there, what, page)

    # While it plays, what is to be clicked is made anew all the time.
    page.keyboard.press("k")
    wait_until(lambda: not player.now.playing, "standing at first", page)
    page.wait_for_timeout(500)
    strip = page.locator("[data-sheath-span]")
    strip.click(position={"x": drawn_width(strip, page) * (20.5 / STEPS), "y": 10})
    at(20, "click on the timeline")
    # The replay is there before the page is: a click means what the plot showed when it was made.
    first = 20 - SPEC.max_steps // 2
    page.locator(f'[data-sheath-plot^="{first} "]').wait_for(state="attached")
    plot = page.locator(".u-over")
    # The plot is as wide as an episode may be long, and shows the present in its middle.
    share = 0.5 + 10.5 / SPEC.max_steps
    plot.click(position={"x": drawn_width(plot, page) * share, "y": 20})
    at(30, "click on the plot")
    for key, step in (("ArrowLeft", 29), ("Shift+ArrowRight", 39), ("Home", 0), ("End", 59)):
        page.keyboard.press(key)
        at(step, key)
    page.keyboard.press("j")
    wait_until(lambda: player.now.backwards and player.now.at < 55, "playing backwards", page)
    page.keyboard.press("k")
    wait_until(lambda: not player.now.playing, "standing", page)
    page.keyboard.press("Home")
    page.keyboard.press("l")
    page.keyboard.press("l")
    wait_until(lambda: player.now.playing and player.now.speed == 2.0, "playing faster", page)
    page.keyboard.press(" ")
    wait_until(lambda: not player.now.playing, "standing again", page)
    page.keyboard.press("Home")
    assert player.now.film is not None
    starts = [start for start, _ in player.now.film.trace.so_far().turns]
    page.keyboard.press("ArrowDown")
    at(next(each for each in starts if each > 0), "the next intervention")

    page.keyboard.press("m")
    # What is typed into the note moves nothing.
    page.keyboard.type("jk <b>slips</b>")
    page.keyboard.press("Enter")
    name, step = store.names()[0], player.now.at
    noted = (Note(step, "jk <b>slips</b>"),)
    wait_until(lambda: store.marks(name).notes == noted, "note in the store", page)
    page.get_by_role("tab", name="Marks").click()
    page.keyboard.press("End")
    row = page.get_by_text(f"step {step + 1}: jk <b>slips</b>")
    row.click()
    at(step, "click on the note")
    page.get_by_role("tab", name="Episodes").click()
    page.locator('[data-sheath-episode="1"]').click()
    wait_until(lambda: player.now.place == 1, "click on an episode", page)
