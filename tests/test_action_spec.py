"""What is an action: a new array of real numbers, within its bounds to the bit."""

import numpy as np
import pytest

from sheath_manip.exceptions import ActionError
from sheath_manip.types import ActionSpec
from tests.faults.ways import NO_ACTIONS
from tests.toy import ACTION

LOWER, UPPER = np.array([-0.3, 0.0], np.float32), np.array([0.3, 1.0], np.float32)
SPEC = ActionSpec(("left_m", "grip"), LOWER, UPPER)


@pytest.mark.parametrize("make", NO_ACTIONS.values(), ids=NO_ACTIONS)
def test_what_is_no_action_is_refused_in_one_line(make):
    with pytest.raises(ActionError) as refused:
        ACTION.validated(make())
    assert len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize(
    "action",
    [[0, 1], (0.1, 0.2), np.array([0, 1]), np.array([0.1, 0.2]), np.array([0.1, 0.2], np.float16)],
)
def test_real_numbers_of_any_kind_are_taken(action):
    taken = SPEC.validated(action)
    assert taken.dtype == np.float32
    np.testing.assert_array_equal(taken, np.array(action, np.float32))


def test_what_leaves_a_bound_by_rounding_is_put_onto_it():
    beyond = np.array([np.nextafter(UPPER[0], np.float32(1)), -5e-7], np.float32)
    taken = SPEC.validated(beyond)
    np.testing.assert_array_equal(taken, [UPPER[0], 0.0])
    with pytest.raises(ActionError, match="leaves its bounds"):
        SPEC.validated([0.3 + 2e-6, 0.0])


def test_what_is_inside_keeps_its_bits():
    inside = np.array([-0.0, 1.0], np.float32)
    assert SPEC.validated(inside).tobytes() == inside.tobytes()


def test_nobody_can_change_it_afterwards():
    given = np.array([0.1, 0.2], np.float32)
    taken = SPEC.validated(given)
    given[:] = 99
    np.testing.assert_array_equal(taken, np.array([0.1, 0.2], np.float32))
    with pytest.raises(ValueError, match="read-only"):
        taken[:] = 99
