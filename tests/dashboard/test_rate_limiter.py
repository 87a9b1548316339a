"""What a moving page shows now and then is not left out of date where it stands still."""

from types import SimpleNamespace
from typing import Any

from sheath_manip.dashboard.rate_limiter import RateLimiter


def at(step: int, paused: bool = False) -> Any:
    return SimpleNamespace(at=step, paused=paused, outcome=None)


def test_only_now_and_then_while_it_moves():
    limiter = RateLimiter(rate_hz=0.001)
    assert [limiter.should_draw(at(step)) for step in (10, 11, 12)] == [True, False, False]
    assert limiter.should_draw(at(40))
    assert limiter.should_draw(at(41, paused=True))


def test_what_was_skipped_is_shown_where_it_stands_still_and_once():
    limiter = RateLimiter(rate_hz=0.001)
    assert limiter.should_draw(at(10))
    assert [limiter.should_draw(at(11)) for _ in range(3)] == [False, True, False]
