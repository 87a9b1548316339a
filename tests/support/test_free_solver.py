"""The dual as a linear system, against libsvm's solution."""

import numpy as np
import pytest

from sheath_manip.support.dense_solver import solve_dense
from sheath_manip.support.free_solver import solve_free
from sheath_manip.support.vectors import squared_distances


def bits(count: int) -> np.ndarray:
    """Binary states, some of them twice, and some near each other."""
    X = np.random.default_rng(0).integers(0, 2, (count, 60)).astype(float)
    X[: count // 8] = X[count // 8 : 2 * (count // 8)]
    X[-40:, 2:] = X[-1, 2:]
    return X - X.mean(axis=0)


@pytest.mark.parametrize("c", [1.0, 2.0])
@pytest.mark.parametrize("nu", [0.05, 0.9])
def test_the_linear_system_has_the_optimum_of_libsvm(c, nu):
    X = bits(400)
    signs = np.ones(400)
    most = np.full(400, 1 / (nu * 400))
    matrix = np.exp(squared_distances(X) / -c)
    expected, expected_rho = solve_dense(matrix, most, 1.0, 1e-7)
    solved = solve_free(X, c, most, signs)
    assert solved is not None
    weights, rho = solved
    assert weights.sum() == pytest.approx(1)
    assert (weights >= 0).all()
    assert (weights <= most * (1 + 1e-9)).all()
    np.testing.assert_allclose(matrix @ weights, matrix @ expected, atol=3e-5 * expected_rho)
    assert rho == pytest.approx(expected_rho, rel=3e-5)


def test_what_no_linear_system_settles_is_left_to_others():
    X = bits(400)
    most = np.full(400, 1 / (0.05 * 400))
    # Far from their mean float32 tells no points apart.
    assert solve_free(X * 1e6, 1.0, most, np.ones(400)) is None
    # One state for and against itself.
    X[1], signs = X[0], np.ones(400)
    signs[1] = -1
    assert solve_free(X, 1.0, most, signs) is None
