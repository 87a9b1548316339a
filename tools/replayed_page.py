"""The replay page of stored episodes in headless Chromium, for pictures of it."""

from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager

from playwright.sync_api import Page

from sheath_manip.dashboard import Replay
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.explainer import Explainer
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.playback.making import FilmMaker
from sheath_manip.task import Task
from tools.chromium import open_dashboard, wait_until


@contextmanager
def replayed(
    page: Page,
    task: Task,
    catalog: EpisodeCatalog,
    explainer: Explainer | None = None,
    fitted: FittedGate | None = None,
) -> Iterator[Replay]:
    """The replay page of the last episode, opened."""
    shown: Future[Replay] = Future()

    def play() -> None:
        maker, last = FilmMaker(task, None, catalog.read, catalog.summary), len(catalog) - 1
        with Replay(
            maker.spec(last),
            catalog,
            maker.film,
            maker.exported,
            maker.clip,
            port=0,
            explainer=explainer,
            fitted=fitted,
        ) as replay:
            shown.set_result(replay)
            replay.run(last)
        maker.close()

    with ThreadPoolExecutor(1) as pool:
        run = pool.submit(play)
        wait_until(lambda: shown.done() or run.done(), "page", page)
        if run.done():
            run.result()
        replay = shown.result()
        try:
            open_dashboard(page, replay.address)
            wait_until(lambda: replay.player.now.film is not None, "film", page)
            yield replay
        finally:
            replay.player.close()
        run.result()
