import pytest

from tests import toy
from tests.browser import browser_page

__all__ = ["browser_page"]


@pytest.fixture
def wide_corridor(monkeypatch) -> None:
    """Nothing is hit, so that an episode is as long as it is."""
    monkeypatch.setattr(toy, "HALF_WIDTH_M", 1e3)
