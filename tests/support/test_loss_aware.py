"""The estimators that know where the policy errs."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from qpsolvers import solve_qp

from sheath_manip.exceptions import ParameterError
from sheath_manip.support.agreeing_states import AgreeingSupport
from sheath_manip.support.loss_aware_svm import LossAwareSupport
from sheath_manip.support.one_class_svm import OneClassSupport
from tests.cases import cases

# daqp gives up on the nearly singular kernel of many points in a plane without it.
RIDGE = 1e-8


def by_generic_solver(X, agrees, nu, nu_error, c, rows):
    """(r,) Σ y_i α_i k(x_i, x) and ρ, the dual of SHIV handed to a QP solver as it is written."""
    signs = np.where(agrees, 1.0, -1.0)
    kernel = np.exp(-((X[:, None] - X[None]) ** 2).sum(-1) / c)
    matrix = kernel * np.outer(signs, signs)
    most = 1 / (np.where(agrees, nu, nu_error) * len(X))
    duals = solve_qp(
        P=matrix + RIDGE * np.eye(len(X)),
        q=np.zeros(len(X)),
        A=np.ones((1, len(X))),
        b=np.ones(1),
        lb=np.zeros(len(X)),
        ub=most,
        solver="daqp",
    )
    assert duals is not None
    free = (duals > 1e-6) & (duals < most - 1e-6)
    rho = float(np.median((matrix @ duals)[free]))
    sums = np.exp(-((rows[:, None] - X[None]) ** 2).sum(-1) / c) @ (signs * duals)
    return sums, rho


@pytest.mark.parametrize("dimensions", [2, 12])
@pytest.mark.parametrize("nu", [0.05, 0.2])
@pytest.mark.parametrize("nu_error", [0.5, 0.9])
@pytest.mark.parametrize("errors", [0.0, 0.1, 0.3])
def test_it_is_the_solution_of_a_generic_solver(dimensions, nu, nu_error, errors):
    rng = np.random.default_rng(0)
    X = rng.normal(size=(120, dimensions))
    agrees = X[:, 0] < np.quantile(X[:, 0], 1 - errors)
    agrees |= errors == 0
    rows = rng.normal(0, 1.5, size=(500, dimensions))
    support = LossAwareSupport(nu, nu_error).fit(X, agrees)
    sums, rho = by_generic_solver(X, agrees, nu, nu_error, support.c_, rows)
    scores = support.decision_function(rows)
    spoken_for = np.isfinite(scores)
    assert (sums[~spoken_for] < 1e-4).all()
    assert spoken_for.sum() > 50
    assert np.corrcoef(support.kernel_sum_(rows), sums)[0, 1] > 0.9999
    np.testing.assert_allclose(scores[spoken_for], (sums - rho)[spoken_for], atol=1e-3)
    clear = np.abs(sums - rho) > 1e-3
    assert ((scores > 0) == (sums > rho))[clear].all()


@pytest.fixture
def square():
    """A square of states, in a patch of which the policy errs, and new states of both kinds."""
    rng = np.random.default_rng(1)
    X, new = rng.uniform(-1, 1, size=(2, 600, 2))
    wrong, new_wrong = (np.linalg.norm(x - [0.4, 0.4], axis=1) < 0.4 for x in (X, new))
    return X, ~wrong, new[~new_wrong], new[new_wrong]


@pytest.mark.parametrize("kind", [LossAwareSupport, AgreeingSupport])
def test_errors_within_the_support_are_flagged(kind, square):
    X, agrees, right, wrong = square
    plain = OneClassSupport(0.05, 0.1).fit(X)
    aware = kind(nu=0.05, bandwidth_factor=0.1).fit(X, agrees)
    assert (plain.decision_function(wrong) < 0).mean() < 0.1
    assert (aware.decision_function(wrong) < 0).mean() > 0.7
    assert (aware.decision_function(right) >= 0).mean() > 0.85


@cases(100)
@given(
    seed=st.integers(0, 2**32 - 1),
    share=st.floats(0, 1),
    nu=st.sampled_from([0.01, 0.1, 0.5]),
    nu_error=st.sampled_from([0.05, 0.5, 0.9]),
    factor=st.sampled_from([0.05, 1.0, 10.0]),
)
def test_no_far_state_passes_whatever_the_errors_and_the_threshold(
    seed, share, nu, nu_error, factor
):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(60, 3))
    agrees = rng.random(60) >= share
    support = LossAwareSupport(nu, nu_error, factor).fit(X, agrees)
    directions = rng.normal(size=(50, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    far = support.decision_function(100 * np.sqrt(support.c_) * directions)
    inside = support.decision_function(X)
    assert (far < 0).all()
    # Also under a threshold that some training state only just passes.
    assert not (far >= inside[np.isfinite(inside)].min(initial=np.inf)).any()
    # A wrong state may drag right ones out, but no more than nu of all.
    if np.isfinite(support.rho_):
        assert (agrees & (inside < -1e-5)).mean() <= nu + 0.01


def test_where_nothing_separates_errors_everything_is_outside():
    X = np.repeat(np.random.default_rng(2).normal(size=(30, 2)), 2, axis=0)
    mixed = np.tile([True, False], 30)
    support = LossAwareSupport(nu=0.9, nu_error=0.9).fit(X, mixed)
    assert support.rho_ == np.inf
    rows = np.concatenate([X, np.full((1, 2), 50.0)])
    for one in (support, LossAwareSupport().load(support.arrays())):
        assert np.isneginf(one.decision_function(rows)).all()
        assert np.isnan(one.decision_function(np.full((1, 2), np.nan))).all()


def test_a_policy_that_is_always_wrong_has_no_support(square):
    X, *_ = square
    nowhere = np.zeros(len(X), dtype=bool)
    assert (LossAwareSupport().fit(X, nowhere).decision_function(X) < 0).all()
    with pytest.raises(ParameterError, match="right in 0 of 600 training states; wanted"):
        AgreeingSupport().fit(X, nowhere)


def test_above_max_points_it_stays_what_it_is(square):
    X, agrees, right, wrong = square
    support = LossAwareSupport(0.05, bandwidth_factor=0.1, max_points=300).fit(X, agrees)
    assert len(support.arrays()["vectors"]) <= 300
    assert (support.decision_function(X[agrees]) >= 0).mean() == pytest.approx(0.95, abs=0.01)
    assert (support.decision_function(wrong) < 0).mean() > 0.5
    assert (support.decision_function(right) >= 0).mean() > 0.85


@pytest.mark.parametrize("kind", [LossAwareSupport, AgreeingSupport])
@pytest.mark.parametrize("agrees", [np.ones(5, dtype=bool), np.ones(600), np.ones((600, 1), bool)])
def test_agreement_of_another_shape_is_refused(kind, agrees, square):
    with pytest.raises(ParameterError, match=r"^agrees is .* wanted bool of shape \(600,\)"):
        kind().fit(square[0], agrees)


def test_nu_error_outside_its_range():
    with pytest.raises(ParameterError, match=r"^nu_error is"):
        LossAwareSupport(nu_error=0.0).fit(np.eye(5))
