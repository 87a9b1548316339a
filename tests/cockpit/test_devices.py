"""What a device may do that is plugged in beside the page, and when the robot stands."""

import numpy as np
import pytest

from sheath_manip.cockpit import Cockpit, Gamepad, OperatorInput, Order, SixAxes
from sheath_manip.cockpit.lease import LOST_AFTER_S
from sheath_manip.types.operator_input import Binding
from tests.cockpit.clock import Clock

GUIDE = (Binding(("KeyI",), "on"),)
KEYS = OperatorInput(keys=frozenset({"KeyI"}))


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def cockpit(clock) -> Cockpit:
    return Cockpit(GUIDE, clock)


def test_a_device_that_is_plugged_in_here_drives_for_the_operator_only(cockpit, clock):
    axes = SixAxes(np.array([0.5, 0, 0, 0, 0, 0]))
    cockpit.turn_axes(axes)
    assert cockpit.now().input is None
    cockpit.order(Order.TAKE_OVER, "one")
    now = cockpit.now()
    assert now.input is not None
    assert now.input.axes is axes
    assert now.input.held
    clock.s += LOST_AFTER_S - 0.1
    cockpit.submit_input("one", OperatorInput())
    clock.s += 0.2
    now = cockpit.now()
    assert now.input is not None
    assert now.input.axes is None


@pytest.mark.parametrize(
    ("given", "held"),
    [
        (OperatorInput(), False),
        (KEYS, True),
        (OperatorInput(pad=Gamepad((1.0, 0.0, 0.0, 0.0), frozenset({0}))), False),
        (OperatorInput(pad=Gamepad((0.0, 0.0, 0.0, 0.0), frozenset({4}))), True),
        (OperatorInput(goal=np.zeros(7)), True),
        (OperatorInput(axes=SixAxes(np.zeros(6))), False),
        (OperatorInput(axes=SixAxes(np.zeros(6), (True, False))), True),
    ],
)
def test_dead_man(given, held):
    assert given.held is held
