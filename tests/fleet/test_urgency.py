"""The one order of all robots' requests."""

import math

import numpy as np
import pytest

from sheath_manip.fleet.urgency import PATIENCE_S, Request, by_urgency
from sheath_manip.types import Reason


def order(*requests: Request) -> list[int]:
    return [each.number for each in by_urgency(requests)]


def test_the_kinds_in_their_order():
    held = Request(1, 50.0, Reason.HOLD)
    stuck = Request(2, 50.0, Reason.STUCK)
    outside = Request(3, 1.0, Reason.OUTSIDE, below=0.1)
    broken = Request(4, 1.0, Reason.POLICY_FAILED, below=math.nan)
    lost = Request(5, 1.0, Reason.OUTSIDE, below=0.0, lost=True)
    overdue = Request(6, PATIENCE_S, Reason.HOLD)
    assert order(held, stuck, outside, broken, lost, overdue) == [6, 5, 4, 3, 2, 1]


def test_the_farther_below_the_threshold_then_the_longer_then_the_lower_number():
    far = Request(3, 1.0, Reason.RISK, below=2.0)
    near = [Request(number, 5.0 * (number == 2), Reason.OUTSIDE, 0.5) for number in (1, 2, 4)]
    assert order(*near, far) == [3, 2, 1, 4]


def test_a_robot_that_asks_without_a_reason_is_served_as_well():
    assert order(Request(1, 0.0), Request(2, 0.0, Reason.NO_SCORE, math.nan)) == [2, 1]


@pytest.mark.parametrize("seed", range(20))
def test_a_request_waits_at_most_its_patience_and_a_turn_for_each_robot(seed):
    """Robots that ask again a moment after each hand-back, the same ones most urgently always."""
    rng = np.random.default_rng(seed)
    robots, turn_s, patience_s = 6, 3.0, 10.0
    asked_s = dict.fromkeys(range(robots), 0.0)
    below = rng.uniform(0.0, 1.0, robots) * np.arange(1, robots + 1)
    now_s = longest_s = 0.0
    served: set[int] = set()
    for _ in range(400):
        waiting = [
            Request(number, now_s - since_s, Reason.OUTSIDE, float(below[number]))
            for number, since_s in asked_s.items()
            if since_s <= now_s
        ]
        if not waiting:
            now_s = min(asked_s.values())
            continue
        first = by_urgency(waiting, patience_s)[0]
        longest_s = max(longest_s, first.waited_s)
        served.add(first.number)
        now_s += rng.uniform(0.1, turn_s)
        asked_s[first.number] = now_s + rng.uniform(0.0, 0.5)
    assert served == set(range(robots))
    assert longest_s <= patience_s + robots * turn_s
