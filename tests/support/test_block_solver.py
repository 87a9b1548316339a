"""The dual solved by blocks, against libsvm's solution of the whole."""

import numpy as np
import pytest
from sklearn.svm import OneClassSVM

from sheath_manip.exceptions import ParameterError
from sheath_manip.support import dual
from sheath_manip.support.agreeing_states import AgreeingSupport
from sheath_manip.support.block_solver import BlockSolver
from sheath_manip.support.dense_solver import solve_dense
from sheath_manip.support.dual import DIRECT_POINTS
from sheath_manip.support.loss_aware_svm import LossAwareSupport
from sheath_manip.support.one_class_svm import OneClassSupport
from sheath_manip.support.vectors import median_squared_distance, squared_distances


def cloud(kind: str, count: int, width: int = 12) -> np.ndarray:
    rng = np.random.default_rng(0)
    X = rng.normal(size=(count, width))
    match kind:
        case "manifold":
            X = np.tanh(rng.normal(size=(count, 3)) @ rng.normal(size=(3, width))) + 0.05 * X
        case "binary":
            X = (X > 0).astype(float)
        case "clusters":
            X += 20 * rng.integers(0, 3, size=(count, 1))
        case "outlier":
            X[0] += 1e4
    return X - np.median(X, axis=0)


@pytest.mark.parametrize("kind", ["normal", "manifold", "binary", "clusters", "outlier"])
@pytest.mark.parametrize("nu", [0.02, 0.5])
@pytest.mark.parametrize("factor", [0.2, 2.0])
@pytest.mark.parametrize("errors", [0.0, 0.1])
def test_blocks_find_the_optimum_of_the_whole(kind, nu, factor, errors):
    X = cloud(kind, 500)
    c = factor * median_squared_distance(X, np.random.default_rng(0))
    signs = np.where(np.random.default_rng(1).random(500) < errors, -1.0, 1.0)
    most = 1 / (500 * np.where(signs > 0, nu, 0.9))
    matrix = np.exp(squared_distances(X) / -c) * signs * signs[:, None]
    expected, expected_rho = solve_dense(matrix, most, 1.0, 1e-6)
    weights, rho = BlockSolver.of(X, c, most, signs).solve()

    assert weights.sum() == pytest.approx(1)
    assert (weights >= 0).all()
    assert (weights <= most * (1 + 1e-9)).all()
    np.testing.assert_allclose(matrix @ weights, matrix @ expected, atol=3e-6)
    assert rho == pytest.approx(expected_rho, abs=2e-6)
    # What lies below the boundary by more than rounding is at its bound, so at most nu of all.
    below = matrix @ weights < rho - 1e-6
    np.testing.assert_allclose(weights[below], most[below])


@pytest.mark.parametrize(
    ("kind", "c", "by_blocks"), [("binary", 0.5, False), ("manifold", 10.0, True)]
)
def test_where_nearly_every_point_counts_no_blocks_are_made(kind, c, by_blocks, monkeypatch):
    X = cloud(kind, 1200)
    most, signs = np.full(1200, 1 / (0.05 * 1200)), np.ones(1200)
    expected, expected_rho = dual.solve_dual(X, c, most, signs)
    monkeypatch.setattr(dual, "DIRECT_POINTS", 1000)
    solved = []
    monkeypatch.setattr(BlockSolver, "solve", lambda *_: solved.append(1) or (expected, 0.0))
    weights, rho = dual.solve_dual(X, c, most, signs)
    assert bool(solved) is by_blocks
    if not by_blocks:
        matrix = np.exp(squared_distances(X) / -c)
        np.testing.assert_allclose(matrix @ weights, matrix @ expected, rtol=3e-5)
        assert rho == pytest.approx(expected_rho, rel=3e-5)


def test_thousands_of_points_agree_with_sklearn_and_repeat():
    X = cloud("manifold", 9000)
    support = OneClassSupport(0.1).fit(X)
    # sklearn's stubs know only the strings that gamma may be.
    gamma = 1 / support.c_
    machine = OneClassSVM(nu=0.1, gamma=gamma).fit(X)  # pyright: ignore[reportArgumentType]
    rows = cloud("manifold", 2000) * 1.2
    same = (support.decision_function(rows) >= 0) == (machine.decision_function(rows) >= 0)
    assert same.mean() >= 0.999
    assert 0.89 < (support.decision_function(X) >= 0).mean() <= 1
    again = OneClassSupport(0.1).fit(X)
    for name, array in support.arrays().items():
        np.testing.assert_array_equal(again.arrays()[name], array)


def test_the_boundary_does_not_jump_where_blocks_begin():
    X = cloud("manifold", DIRECT_POINTS + 1)
    whole, blocks = OneClassSupport(0.1).fit(X[:-1]), OneClassSupport(0.1).fit(X)
    assert blocks.rho_ == pytest.approx(whole.rho_, rel=1e-2)
    np.testing.assert_allclose(blocks.decision_function(X), whole.decision_function(X), atol=5e-3)


@pytest.mark.parametrize("kind", [OneClassSupport, LossAwareSupport])
def test_a_refit_finds_what_a_fit_finds(kind):
    X = cloud("normal", 6600)
    agrees = X[:, 0] < 1
    cold = kind(0.1).fit(X, agrees)
    # The states may have been embedded anew since.
    warm = kind(0.1).fit(1.1 * X[:5500] + 0.01, agrees[:5500]).refit(X, agrees)
    assert warm.c_ == cold.c_
    assert warm.rho_ == pytest.approx(cold.rho_, abs=1e-6)
    ours, theirs = warm.decision_function(X), cold.decision_function(X)
    np.testing.assert_allclose(ours, theirs, atol=2e-6)


def test_without_a_fit_to_continue_from_a_refit_is_a_fit():
    X = cloud("normal", 300)
    fitted = OneClassSupport().fit(X)
    rows = 1.5 * X
    for other in (OneClassSupport(), OneClassSupport().load(fitted.arrays())):
        np.testing.assert_array_equal(
            other.refit(X).decision_function(rows), fitted.decision_function(rows)
        )


def test_a_refit_to_fewer_states_is_refused():
    X = cloud("normal", 300)
    with pytest.raises(ParameterError, match=r"cannot refit to 200 vectors after 300; wanted"):
        OneClassSupport().fit(X).refit(X[:200])


def test_thousands_of_states_with_errors_keep_what_is_right():
    X = np.random.default_rng(3).uniform(-1, 1, size=(5000, 2))
    wrong = np.linalg.norm(X - [0.4, 0.4], axis=1) < 0.4
    for kind in (LossAwareSupport, AgreeingSupport):
        scores = kind(nu=0.05, bandwidth_factor=0.1).fit(X, ~wrong).decision_function(X)
        assert (scores[wrong] < 0).mean() > 0.7
        assert (scores[~wrong] >= 0).mean() > 0.9
