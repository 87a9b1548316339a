from collections.abc import Iterator

import pytest

from sheath_manip.policies import POLICIES
from tests.learning.corridor_run import SMALL, small_policy
from tests.writing import writes_here

__all__ = ["writes_here"]


@pytest.fixture(scope="module")
def small_policy_known() -> Iterator[None]:
    with POLICIES.including(SMALL, small_policy()):
        yield
