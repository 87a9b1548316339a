"""How many generated cases a test meets: few in `make test`, many in `make soak`."""

from collections.abc import Iterable
from typing import Any

import pytest
from hypothesis import settings

SOAK = "soak"
"""marker of tests, and hypothesis' profile, that `make soak` asks for"""
TIMES = 8


def cases(count: int, **options: Any) -> settings:
    """So many cases of a hypothesis test, and `TIMES` as many in `make soak`.

    Without a deadline: the machine's speed is no property of the code.
    """
    times = TIMES if settings.get_current_profile_name() == SOAK else 1
    return settings(max_examples=times * count, deadline=None, **options)


def first_of(few: int, numbers: Iterable[int]) -> list[Any]:
    """Numbers to parametrize with; all but the first `few` are for `make soak`."""
    return [
        pytest.param(number, marks=[pytest.mark.soak] if place >= few else [])
        for place, number in enumerate(numbers)
    ]
