"""Asserts of all modules here say what they compared; and hypothesis' profile for `make soak`.

`tests.cases` reads which profile is in force.
"""

import pytest
from hypothesis import settings

# Before any of them is imported: pytest by itself rewrites only those that it collects.
pytest.register_assert_rewrite("tests")

from tests.cases import SOAK  # noqa: E402

settings.register_profile(SOAK, deadline=None)
