"""Stops within acceleration and jerk, to the rounding."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sheath_manip.controllers.joint_limits import JointLimits
from sheath_manip.controllers.stopping import Stopping
from sheath_manip.exceptions import ParameterError
from tests.cases import cases

TIMESTEP_S = 0.05
SPEEDS = np.array([1.5, 2.0, 3.0])
share = st.floats(-1.0, 1.0)


def stopping(rise_s: float = 0.15, onset_s: float = 0.05) -> Stopping:
    far = np.full(3, 10.0)
    accelerations = SPEEDS / rise_s
    limits = JointLimits(-far, far, SPEEDS, accelerations, accelerations / onset_s)
    return Stopping(limits, TIMESTEP_S)


@cases(200)
@given(
    st.sampled_from([(0.15, 0.05), (0.15, 0.2), (0.3, 0.1), (0.05, 0.05), (0.02, 0.3)]),
    st.lists(st.tuples(share, share), min_size=3, max_size=3),
)
def test_every_motion_is_stopped_within_the_limits(ramps, motion):
    stops = stopping(*ramps)
    # Twice the top speed: from one direction to the other.
    velocities = np.array([2 * speed for speed, _ in motion]) * SPEEDS
    last = np.array([change for _, change in motion]) * stops.most_change
    changes = stops.changes(velocities, last)
    assert changes is not None
    assert 1 <= len(changes) <= stops.steps
    np.testing.assert_allclose(velocities + changes.sum(0), 0, atol=1e-9)
    assert (np.abs(changes) <= stops.most_change + 1e-12).all()
    jerks = np.diff(np.vstack([last, changes, np.zeros(3)]), axis=0)
    assert (np.abs(jerks) <= stops.most_jerk + 1e-12).all()


def test_a_stop_takes_no_step_more_than_it_must():
    stops = stopping(rise_s=0.15, onset_s=0.15)
    # A third of the top speed is a full change, a ninth the jerk's: 1 + 2 + 3 + 2 + 1 ninths.
    for ninths, steps in ((1, 1), (2, 2), (4, 3), (4.1, 4), (6, 4), (9, 5), (9.1, 6)):
        changes = stops.changes(SPEEDS * ninths / 9, np.zeros(3))
        assert changes is not None
        assert len(changes) == steps


def test_what_cannot_be_stopped_in_time_has_no_stop():
    assert stopping().changes(20 * SPEEDS, np.zeros(3)) is None


def test_limits_that_contradict_each_other_are_refused():
    one = np.ones(2)
    with pytest.raises(ParameterError, match="positive"):
        JointLimits(-one, one, one, 0 * one, one)
    with pytest.raises(ParameterError, match="lower end"):
        JointLimits(one, -one, one, one, one)
