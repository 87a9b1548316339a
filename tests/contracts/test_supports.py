"""What every support estimator of the table must do."""

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.support import SUPPORTS, make_support


@pytest.fixture(params=sorted(SUPPORTS))
def name(request) -> str:
    return request.param


@pytest.fixture
def points() -> np.ndarray:
    return np.random.default_rng(0).normal(size=(300, 8))


def test_scores_are_positive_inside_and_negative_far_away(name, points):
    support = make_support(name).fit(points)
    scores = support.decision_function(points)
    assert scores.shape == (300,)
    assert scores.dtype == np.float64
    assert (scores >= 0).mean() >= 0.9
    far = support.decision_function(np.stack([np.full(8, 20.0), np.full(8, 1e30)]))
    assert (far < 0).all()


def test_what_is_not_finite_scores_nan(name, points):
    support = make_support(name).fit(points)
    rows = np.zeros((4, 8))
    rows[1, 3], rows[2, 0], rows[3, 1] = np.nan, np.inf, -np.inf
    assert np.isnan(support.decision_function(rows)).tolist() == [False, True, True, True]


def test_is_repeatable_and_loads(name, points):
    support = make_support(name).fit(points)
    scores = support.decision_function(points)
    for other in (make_support(name).fit(points), make_support(name).load(support.arrays())):
        np.testing.assert_array_equal(other.decision_function(points), scores)


def test_no_rows_give_no_scores(name, points):
    assert make_support(name).fit(points).decision_function(points[:0]).shape == (0,)


@pytest.mark.parametrize(
    "data",
    [np.zeros(5), np.zeros((1, 3)), np.zeros((4, 0)), np.full((4, 3), np.nan), np.ones((4, 3))],
    ids=["one axis", "one point", "no features", "not finite", "all equal"],
)
def test_data_it_cannot_fit_is_named_in_one_line(name, data):
    with pytest.raises(ParameterError, match="wanted") as caught:
        make_support(name).fit(data)
    assert "\n" not in str(caught.value)


def test_rows_of_another_width_are_refused(name, points):
    with pytest.raises(ParameterError, match=r"wanted \(n, 8\)"):
        make_support(name).fit(points).decision_function(points[:, :5])


def test_unknown_name():
    with pytest.raises(UnknownNameError, match="one-class-svm"):
        make_support("two-class-svm")
