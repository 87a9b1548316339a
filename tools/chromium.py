"""Headless Chromium on the dashboard, for browser tests and screenshots."""

import io
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from PIL import Image
from playwright.sync_api import Locator, Page, sync_playwright

from sheath_manip.exceptions import SetupError

CHROMIUM = Path("/usr/bin/chromium")
# Mesa draws in software some forty times as fast as Chromium's own SwiftShader.
FLAGS = (
    "--use-gl=angle",
    "--use-angle=gl-egl",
    "--ignore-gpu-blocklist",
    "--no-sandbox",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
)
SIZE_PX = (1400, 900)
TIMEOUT_S = 60.0


@contextmanager
def chromium_page() -> Iterator[Page]:
    """An empty page of a headless Chromium; raises SetupError where there is none."""
    if not CHROMIUM.exists():
        raise SetupError(
            f"{CHROMIUM} is missing; `apt-get install chromium` or `make browser` installs it"
        )
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        page = browser.new_page(viewport={"width": SIZE_PX[0], "height": SIZE_PX[1]})
        page.set_default_timeout(1000 * TIMEOUT_S)
        yield page
        browser.close()


def open_dashboard(page: Page, address: str) -> None:
    """Go to a dashboard's printed `address`, whose page leads on to one without the token.

    On a busy machine the second navigation begins before the first one has loaded, which would
    then count as aborted: so the first need only have been answered.
    """
    page.goto(address, wait_until="commit")
    page.wait_for_url(lambda url: "token" not in url)


def wait_until(
    condition: Callable[[], bool], what: str, page: Page, timeout_s: float = TIMEOUT_S
) -> None:
    """Wait for something beside the page; raises TimeoutError naming `what`."""
    deadline_s = time.monotonic() + timeout_s
    while not condition():
        if time.monotonic() > deadline_s:
            raise TimeoutError(f"no {what} within {timeout_s:.0f} s")
        # Not time.sleep, because the page's events are handled in here.
        page.wait_for_timeout(50)


def drawn_width(locator: Locator, page: Page) -> float:
    """Width in pixels of what may be made anew, and so be away, at the moment of asking."""
    widths: list[float] = []

    def is_drawn() -> bool:
        box = locator.bounding_box()
        widths.extend([] if box is None else [box["width"]])
        return bool(widths)

    wait_until(is_drawn, "place to click on", page)
    return widths[-1]


def take_picture(page: Page, path: Path) -> None:
    """Write a picture of what the page shows."""
    png = page.screenshot(timeout=1000 * TIMEOUT_S)
    # 256 colours are enough for what is drawn, at a third of the size.
    image = Image.open(io.BytesIO(png)).convert("RGB")
    image.quantize(256, method=Image.Quantize.FASTOCTREE).save(path, optimize=True)
    print(path)
