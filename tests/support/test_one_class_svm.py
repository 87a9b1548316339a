import numpy as np
import pytest
from sklearn.svm import OneClassSVM

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.support.one_class_svm import OneClassSupport


@pytest.mark.parametrize("nu", [0.01, 0.05, 0.3])
@pytest.mark.parametrize("dimensions", [2, 64, 1280])
@pytest.mark.parametrize("factor", [0.01, 0.1, 1.0, 10.0])
def test_nu_bounds_the_training_points_outside(nu, dimensions, factor):
    points = np.random.default_rng(1).normal(3, 2, size=(400, dimensions))
    support = OneClassSupport(nu, factor).fit(points)
    assert (support.decision_function(points) >= 0).mean() >= 1 - nu - 0.01
    # The margin for rounding must not let in what is unlike every point.
    assert (support.decision_function(points + 100) < 0).all()


@pytest.mark.parametrize("factor", [0.003, 0.02])
def test_nu_holds_for_repeated_binary_features(factor):
    rng = np.random.default_rng(2)
    points = rng.integers(0, 2, size=(500, 40)).astype(float)
    points = points[rng.integers(0, 300, 500)]
    support = OneClassSupport(0.05, factor).fit(points)
    assert (support.decision_function(points) >= 0).mean() >= 0.94


@pytest.mark.parametrize("factor", [0.003, 0.01])
@pytest.mark.parametrize("nu", [0.02, 0.1])
def test_nu_holds_for_binary_features_with_a_bandwidth_by_their_number(factor, nu):
    """Where c is less than the distance of most states nearly all sit on the boundary."""
    rng = np.random.default_rng(6)
    # Walks that flip a few of 400 bits a step, stand still at times and come back.
    flips = rng.random((600, 400)) < 0.004 * rng.integers(0, 2, (600, 1))
    states = (np.cumsum(flips, axis=0) % 2).astype(np.float32)
    states = np.concatenate([states, states[::7]])
    support = OneClassSupport(nu, factor, bandwidth_unit="dimensions").fit(states)
    assert support.c_ == pytest.approx(factor * 400)
    assert (support.decision_function(states) >= 0).mean() >= 1 - nu - 1e-3
    # One by one as in a batch: float32 sums differ in their last bits.
    single = [support.decision_function(state[None])[0] for state in states[:200]]
    assert np.mean(np.array(single) >= 0) >= 1 - nu - 0.02
    assert (support.decision_function(1 - states) < 0).all()


def test_an_unknown_unit_of_the_bandwidth_is_named():
    with pytest.raises(UnknownNameError, match="known: dimensions, median"):
        OneClassSupport(bandwidth_unit="features").fit(np.eye(5))


@pytest.mark.parametrize("dimensions", [2, 128])
@pytest.mark.parametrize("nu", [0.05, 0.3])
def test_signs_are_those_of_sklearn(dimensions, nu):
    rng = np.random.default_rng(3)
    points = rng.normal(5, 1, size=(500, dimensions))
    rows = rng.normal(5, 1.5, size=(2000, dimensions))
    support = OneClassSupport(nu).fit(points)
    # sklearn's stubs know only the strings that gamma may be.
    gamma = 1 / support.c_
    reference = OneClassSVM(nu=nu, gamma=gamma, tol=1e-6)  # pyright: ignore[reportArgumentType]
    reference.fit(points)
    expected = reference.decision_function(rows) / np.asarray(reference.dual_coef_).sum()
    band = 1e-4 * nu + 2e-6
    clear = np.abs(expected) > band
    assert clear.mean() > 0.95
    scores = support.decision_function(rows)
    assert (np.sign(scores) == np.sign(expected))[clear].all()
    np.testing.assert_allclose(scores, expected, atol=band)


def test_the_bandwidth_follows_the_units():
    points = np.random.default_rng(4).normal(size=(200, 5))
    metres, millimetres = OneClassSupport().fit(points), OneClassSupport().fit(1000 * points)
    assert millimetres.c_ == pytest.approx(1e6 * metres.c_)
    np.testing.assert_allclose(
        millimetres.decision_function(1000 * points), metres.decision_function(points), atol=1e-6
    )


def test_above_max_points_nu_still_holds_for_all():
    points = np.random.default_rng(5).normal(size=(3000, 10))
    support = OneClassSupport(0.1, max_points=300).fit(points)
    assert len(support.arrays()["vectors"]) <= 300
    assert (support.decision_function(points) >= 0).mean() == pytest.approx(0.9, abs=0.01)


@pytest.mark.parametrize(
    ("parameters", "named"),
    [
        ({"nu": 0.0}, "nu"),
        ({"nu": 1.5}, "nu"),
        ({"nu": float("nan")}, "nu"),
        ({"bandwidth_factor": 0.0}, "bandwidth_factor"),
        ({"bandwidth_factor": float("inf")}, "bandwidth_factor"),
        ({"max_points": 1}, "max_points"),
    ],
)
def test_parameters_outside_their_range(parameters, named):
    with pytest.raises(ParameterError, match=f"^{named} is .* wanted"):
        OneClassSupport(**parameters).fit(np.eye(5))


def test_arrays_that_do_not_belong_together_are_refused():
    arrays = dict(OneClassSupport().fit(np.eye(5)).arrays())
    arrays["center"] = np.zeros(3, dtype=np.float32)
    with pytest.raises(ParameterError, match="support vectors have shape"):
        OneClassSupport().load(arrays)
