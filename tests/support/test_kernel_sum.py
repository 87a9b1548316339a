import numpy as np
import pytest

from sheath_manip.support.gaussian import COLUMNS
from sheath_manip.support.kernel_sum import KernelSum
from sheath_manip.support.one_class_svm import OneClassSupport


def directly(center, vectors, weights, c, rows):
    """(r,) the sum as it is written, in float64."""
    apart = ((rows[:, None] - center - vectors[None]) ** 2).sum(axis=-1)
    return np.exp(-apart / c) @ weights


@pytest.mark.parametrize("count", [1, 7, 300, COLUMNS + 5])
@pytest.mark.parametrize("rows", [1, 3, 700])
def test_it_is_the_sum_as_it_is_written(count, rows):
    rng = np.random.default_rng(0)
    center, vectors = rng.normal(size=3), rng.normal(size=(count, 3))
    weights = rng.uniform(-1, 1, size=count)
    X = rng.normal(0, 2, size=(rows, 3))
    sums = KernelSum(center, vectors, weights, 5.0)(X)
    expected = directly(center, vectors, weights, 5.0, X[:40])
    np.testing.assert_allclose(sums[:40], expected, atol=1e-6 * np.abs(weights).sum())


def test_far_rows_sum_to_nothing_and_rows_that_are_not_finite_to_nan():
    vectors = np.eye(3)
    X = np.array(
        [[0, 0, 0], [1e3, 0, 0], [1e25, 0, 0], [1e200, 0, 0], [0, np.nan, 0], [np.inf] * 3]
    )
    for rows in (X, X[1:]):
        sums = KernelSum(np.zeros(3), vectors, np.ones(3), 1.0)(rows)
        np.testing.assert_array_equal(sums[-5:], [0, 0, 0, np.nan, np.nan])
    one_by_one = [KernelSum(np.zeros(3), vectors, np.ones(3), 1.0)(row[None])[0] for row in X[1:]]
    np.testing.assert_array_equal(one_by_one, [0, 0, 0, np.nan, np.nan])


def test_vectors_far_from_the_others_do_not_overflow():
    far = 1e6 + np.random.default_rng(0).normal(size=(50, 4))
    vectors = np.concatenate([far, -far])
    sums = KernelSum(np.zeros(4), vectors, np.full(100, 0.01), 1.0)(vectors)
    assert (sums <= 1 + 1e-6).all()
    assert (sums >= 0).all()


@pytest.mark.parametrize("offset", [0.0, 1e5])
def test_data_far_from_zero_for_its_spread_keeps_its_support(offset):
    X = np.random.default_rng(1).normal(size=(500, 6))
    scores = OneClassSupport(0.1).fit(X + offset).decision_function(X + offset)
    np.testing.assert_allclose(scores, OneClassSupport(0.1).fit(X).decision_function(X), atol=1e-5)
