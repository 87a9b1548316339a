"""Whether a threshold is warned of under which there is hardly a state."""

import warnings

import numpy as np
import pytest

from sheath_manip.exceptions import GateWarning
from sheath_manip.protocols import HasFloor
from sheath_manip.support import SUPPORTS, make_support
from sheath_manip.support.calibration import held_out_threshold
from sheath_manip.support.loss_aware_svm import LossAwareSupport
from sheath_manip.support.one_class_svm import OneClassSupport
from sheath_manip.support.reach import LEAST_SHARE, warn_out_of_reach

QUICK = {
    "reconstruction": {"steps": 20},
    "distillation": {"steps": 20},
    "disagreement": {"steps": 10},
}


def episodes(count: int, apart: float) -> list[np.ndarray]:
    """Episodes of 100 states in a plane, each around a place of its own."""
    rng = np.random.default_rng(0)
    return [rng.normal(size=(100, 2)) + apart * rng.normal(size=2) for _ in range(count)]


@pytest.mark.parametrize("name", SUPPORTS)
def test_a_support_that_has_a_floor_says_so(name):
    points = np.concatenate(episodes(3, 1.0))
    support = make_support(name, **QUICK.get(name, {})).fit(points)
    near, far = support.decision_function(np.array([[1e4, 0], [1e8, 1e8]]))
    if isinstance(support, HasFloor):
        assert support.far_score == near == far
    else:
        assert far < 10 * near < 0


def test_what_was_loaded_has_the_same_floor():
    support = OneClassSupport().fit(np.concatenate(episodes(3, 1.0)))
    assert OneClassSupport().load(support.arrays()).far_score == support.far_score < 0
    # What no threshold lets in needs no warning.
    assert LossAwareSupport().fit(np.concatenate(episodes(3, 1.0))).far_score == -np.inf


def test_few_unlike_episodes_are_warned_of_and_many_alike_are_not():
    alike = episodes(13, 0.0)
    support = OneClassSupport().fit(np.concatenate(alike[:3]))
    scores = [support.decision_function(each + 9.0) for each in alike[3:6]]
    said = r"threshold is -0.*scores -0.*more episodes than 3"
    with pytest.warns(GateWarning, match=said) as told:
        threshold = held_out_threshold(scores, 0.05, far_score=support.far_score)
    assert len(told) == 1
    # At the line of who called, so that Python says it there, and once.
    assert told[0].filename == __file__
    assert threshold == held_out_threshold(scores, 0.05)
    support = OneClassSupport().fit(np.concatenate(alike[:10]))
    scores = [support.decision_function(each) for each in alike[10:]]
    held_out_threshold(scores, 0.05, far_score=support.far_score)


def test_where_the_line_is_drawn():
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        warn_out_of_reach(-0.2 * (1 - LEAST_SHARE) + 1e-9, -0.2, 3)
        warn_out_of_reach(0.0, -0.2, 3)
        # A score without a floor, and a gate that lets nothing in.
        warn_out_of_reach(-9.0, -np.inf, 3)
        warn_out_of_reach(3e38, -0.2, 3)
        assert told == []
        warn_out_of_reach(-0.2 * (1 - LEAST_SHARE) - 1e-9, -0.2, 3)
        warn_out_of_reach(-9.0, -0.2, 3)
        assert len(told) == 2
