import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.adjustable import Adjustable, Boundary, Dial, around
from sheath_manip.gates.support import SupportGate
from sheath_manip.types import Actor, Observation, Proposal, Reason
from tests.judging import always

SEEN = Observation({}, np.zeros(1, np.float32), 0.0)
PROPOSED = Proposal(np.zeros((1, 1), np.float32))


def test_the_next_step_goes_by_the_new_boundary() -> None:
    dial = Dial(Boundary(always(0.5, Reason.RISK), 0.0, -1.0, 1.0))
    gate = Adjustable(SupportGate(always(np.nan), 0.0), dial)
    gate.reset(np.random.default_rng(0))
    first = gate.decide(SEEN, PROPOSED)
    assert (first.actor, first.score, first.threshold) == (Actor.POLICY, 0.5, 0.0)
    dial.boundary = dial.boundary.at(7.0)
    second = gate.decide(SEEN, PROPOSED)
    assert (second.actor, second.threshold, second.reason) == (Actor.EXPERT, 1.0, Reason.RISK)
    dial.boundary = Boundary(always(9.0), 2.0, 0.0, 4.0)
    assert gate.decide(SEEN, PROPOSED).actor is Actor.POLICY


@pytest.mark.parametrize("threshold", [np.nan, np.inf])
def test_a_threshold_that_is_no_number_is_refused(threshold: float) -> None:
    with pytest.raises(ParameterError, match="finite"):
        Boundary(always(0.0), 0.0, -1.0, 1.0).at(threshold)


def test_the_range_holds_the_scores_and_the_threshold() -> None:
    known = around(always(0.0), -3.0, np.array([-np.inf, -2.0, np.nan, 4.0]))
    assert known.lowest < -3.0
    assert known.highest > 4.0
    unknown = around(always(0.0), -3.0, np.zeros(0))
    assert (unknown.lowest, unknown.highest) == (-6.0, 0.0)
