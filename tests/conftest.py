"""Asserts that say what they compared, hypothesis' profile for `make soak`, lost listeners.

`tests.cases` reads which profile is in force.
"""

import logging
from collections.abc import Iterator

import pytest
from hypothesis import settings

# Before any of them is imported: pytest by itself rewrites only those that it collects.
pytest.register_assert_rewrite("tests")

from sheath_manip.rollout import audience  # noqa: E402
from tests.cases import SOAK  # noqa: E402

settings.register_profile(SOAK, deadline=None)


@pytest.fixture(autouse=True)
def dropped_listeners() -> Iterator[list[str]]:
    """Collect the lines of listeners that failed; a test that expects any takes them off the list.

    An assertion in a listener would be lost otherwise: the loop goes on without it.
    """
    told: list[str] = []
    handler = logging.Handler()
    handler.emit = lambda record: told.append(record.getMessage())
    audience.logger.addHandler(handler)
    yield told
    audience.logger.removeHandler(handler)
    assert not told


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest: at the end one worker would wait for it, with nothing left to do."""
    items.sort(key=lambda item: item.path.name != "test_wheel.py")
