import pytest

from tests import toy

# What they assert is told as in a test.
pytest.register_assert_rewrite("tests.cockpit.operated_corridor", "tests.cockpit.promised_cockpit")


@pytest.fixture
def wide_corridor(monkeypatch) -> None:
    """Nothing is hit, so that an episode is as long as it is."""
    monkeypatch.setattr(toy, "HALF_WIDTH_M", 1e3)
