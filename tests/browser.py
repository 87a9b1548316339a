"""One Chromium, the windows that the pages are tried in, and a checker of what hinders people."""

from collections.abc import Iterator

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page

from tools.chromium import chromium_page, wait_until

SIZES = {"desk": (1400, 900), "tablet": (1024, 768), "phone": (390, 844)}
"""width and height in pixels"""


@pytest.fixture(scope="module")
def browser_page() -> Iterator[Page]:
    """An empty page of one Chromium for each file; a folder's conftest.py makes it known."""
    with chromium_page() as page:
        yield page


def resize(page: Page, size: str) -> None:
    """Give the page's window one of the SIZES."""
    width, height = SIZES[size]
    page.set_viewport_size({"width": width, "height": height})


def await_no_serious_fault(page: Page) -> None:
    """Wait until axe-core finds no serious fault.

    An element's name is given as soon as the page is at rest, and colours change over a moment.
    """
    faults: list[str] = []

    def is_clean() -> bool:
        found = Axe().run(page).response["violations"]
        faults[:] = [
            f"{each['id']}: {each['nodes'][0]['html'][:120]}"
            for each in found
            if each["impact"] in ("serious", "critical")
        ]
        return not faults

    try:
        wait_until(is_clean, "page without a fault", page)
    except TimeoutError:
        pytest.fail(str(faults))
