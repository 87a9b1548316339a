"""The gripper closes at its speed, squeezes with a bounded lead and lets go at once."""

import pytest

from sheath_manip.controllers.closing_control import ClosingControl

CONTROL = ClosingControl(opening_m=0.09, speed_m_s=0.1, squeeze_m=0.02)


def test_closes_at_its_speed():
    assert CONTROL.target_m(0.0, 0.0, 1.0, 0.05) == pytest.approx(0.005)
    assert CONTROL.target_m(0.05, 0.05, -1.0, 0.05) == pytest.approx(0.045)


def test_leads_fingers_that_are_held_by_no_more_than_the_squeeze():
    target = 0.03
    for _ in range(50):
        target = CONTROL.target_m(target, 0.03, 1.0, 0.05)
    # What a step adds comes on top, and is taken back by the next.
    assert 0.05 <= target <= 0.0551
    for _ in range(5):
        target = CONTROL.target_m(target, 0.03, -1.0, 0.05)
    assert target <= 0.03


@pytest.mark.parametrize(("grip", "wanted_m"), [(-0.6, 0.025), (0.6, 0.035)])
def test_nearly_open_is_open_and_nearly_closed_closed(grip, wanted_m):
    assert CONTROL.target_m(0.03, 0.03, grip, 0.05) == pytest.approx(wanted_m)


def test_a_grip_holds_a_width():
    for closed_m in (0.0, 0.03, 0.09):
        grip = CONTROL.holding_grip(closed_m)
        assert CONTROL.target_m(closed_m, closed_m, grip, 0.05) == pytest.approx(closed_m)
