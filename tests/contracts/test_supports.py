"""What every support estimator of the table must do."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.protocols import SupportEstimator
from sheath_manip.support import SUPPORTS, make_support, support_hyperparameters
from sheath_manip.support.config import SupportConfig
from tests.cases import cases

# They train a network; what holds for every fit holds for a rough one.
STEPS = {"reconstruction": 50, "distillation": 50, "disagreement": 8}


@pytest.fixture(params=sorted(SUPPORTS))
def name(request) -> str:
    return request.param


@pytest.fixture
def points() -> np.ndarray:
    return np.random.default_rng(0).normal(size=(300, 8))


def quick(name: str, nu: float = 0.05) -> SupportEstimator:
    return make_support(name, nu=nu, **({"steps": STEPS[name]} if name in STEPS else {}))


def test_scores_are_positive_inside_and_negative_far_away(name, points):
    support = make_support(name).fit(points)
    scores = support.decision_function(points)
    assert scores.shape == (300,)
    assert scores.dtype == np.float64
    far = support.decision_function(np.stack([np.full(8, 20.0), np.full(8, 1e30)]))
    assert (far < 0).all()


@pytest.mark.parametrize("nu", [0.01, 0.05, 0.5, 1.0])
@pytest.mark.parametrize("dimensions", [2, 200])
def test_at_most_nu_of_the_training_points_lie_outside(name, dimensions, nu):
    points = np.random.default_rng(1).normal(3, 2, size=(400, dimensions))
    scores = quick(name, nu).fit(points).decision_function(points)
    assert (scores >= 0).mean() >= 1 - nu - 0.01


def test_the_boundary_is_not_far_beyond_the_points(name):
    points = np.random.default_rng(2).normal(size=(500, 4))
    outside = quick(name, 0.2).fit(points).decision_function(points) < 0
    assert outside.mean() >= 0.1


@st.composite
def clouds(draw) -> np.ndarray:
    """Points of any scale and place, in clusters, on a plane, repeated, binary, with an outlier."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count, dimensions = draw(st.integers(2, 120)), draw(st.integers(1, 40))
    X = rng.normal(size=(count, dimensions))
    match draw(st.sampled_from(["normal", "clusters", "flat", "binary", "repeated", "outlier"])):
        case "clusters":
            X += 20 * rng.integers(0, 3, size=(count, 1))
        case "flat":
            X[:, dimensions // 2 + 1 :] = 0
        case "binary":
            X = (X > 0).astype(float)
        case "repeated":
            X = X[rng.integers(0, count // 3 + 1, size=count)]
        case "outlier":
            X[0] += 50
    # The last point differs, so that the cloud has a scale.
    X[-1, 0] += X.std() + 1
    return (X + draw(st.floats(-10, 10))) * 10.0 ** draw(st.integers(-4, 4))


@pytest.mark.parametrize("name", sorted(SUPPORTS))
@cases(25, suppress_health_check=[HealthCheck.too_slow])
@given(X=clouds(), nu=st.sampled_from([0.01, 0.05, 0.3, 1.0]), seed=st.integers(0, 2**32 - 1))
def test_far_away_is_outside_for_every_fit(name, X, nu, seed):
    """100 bandwidths off in any direction, also along a feature that never moved."""
    rng = np.random.default_rng(seed)
    support = quick(name, nu).fit(X)
    bandwidth = np.sqrt(2 * ((X - X.mean(axis=0)) ** 2).sum(axis=1).mean())
    directions = np.concatenate([rng.normal(size=(20, X.shape[1])), np.eye(X.shape[1])])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    starts = X[rng.integers(0, len(X), size=len(directions))]
    for distance in (100, 1e4, 1e12):
        far = support.decision_function(starts + distance * bandwidth * directions)
        assert (far < 0).all()


def test_what_is_not_finite_scores_nan(name, points):
    support = quick(name).fit(points)
    rows = np.zeros((4, 8))
    rows[1, 3], rows[2, 0], rows[3, 1] = np.nan, np.inf, -np.inf
    assert np.isnan(support.decision_function(rows)).tolist() == [False, True, True, True]
    assert np.isnan(support.decision_function(rows[1:])).all()


def test_is_repeatable_and_loads(name, points):
    agrees = np.random.default_rng(1).random(300) < 0.9
    support = quick(name).fit(points, agrees)
    scores = support.decision_function(points)
    loaded = quick(name).load(support.arrays())
    for other in (support, quick(name).fit(points, agrees), loaded):
        np.testing.assert_array_equal(other.decision_function(points), scores)
    for key, array in support.arrays().items():
        assert array.dtype.kind in "fi", key
        np.testing.assert_array_equal(loaded.arrays()[key], array)


def test_one_row_scores_as_among_many(name, points):
    support = quick(name).fit(points)
    alone = [support.decision_function(points[i : i + 1])[0] for i in range(20)]
    np.testing.assert_allclose(alone, support.decision_function(points)[:20], atol=1e-5)


def test_the_units_do_not_matter(name, points):
    metres, millimetres = quick(name).fit(points), quick(name).fit(1000 * points)
    rows = np.random.default_rng(3).normal(0, 2, size=(200, 8))
    np.testing.assert_allclose(
        millimetres.decision_function(1000 * rows), metres.decision_function(rows), atol=1e-3
    )


def test_agreement_everywhere_is_the_default(name, points):
    default, stated = (
        quick(name).fit(points, agrees).decision_function(points)
        for agrees in (None, np.ones(300, dtype=bool))
    )
    np.testing.assert_array_equal(default, stated)


def test_agreement_matters_where_it_is_used(name, points):
    agrees = points[:, 0] < 0.5
    support = quick(name)
    plain = quick(name).fit(points).decision_function(points)
    told = support.fit(points, agrees).decision_function(points)
    assert np.array_equal(plain, told) == (not support.uses_agreement)


def test_no_rows_give_no_scores(name, points):
    assert quick(name).fit(points).decision_function(points[:0]).shape == (0,)


@pytest.mark.parametrize(
    "data",
    [np.zeros(5), np.zeros((1, 3)), np.zeros((4, 0)), np.full((4, 3), np.nan), np.ones((4, 3))],
    ids=["one axis", "one point", "no features", "not finite", "all equal"],
)
def test_data_it_cannot_fit_is_named_in_one_line(name, data):
    with pytest.raises(ParameterError, match="wanted") as caught:
        quick(name).fit(data)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("nu", [0.0, -0.1, 1.5, float("nan")])
def test_nu_outside_its_range(name, nu, points):
    with pytest.raises(ParameterError, match=r"^nu is .* wanted a share"):
        quick(name, nu).fit(points)


def test_rows_of_another_width_are_refused(name, points):
    with pytest.raises(ParameterError, match=r"wanted \(n, 8\)"):
        quick(name).fit(points).decision_function(points[:, :5])


def test_arrays_that_do_not_belong_together_are_refused(name, points):
    arrays = dict(quick(name).fit(points).arrays())
    arrays["center"] = np.zeros(3)
    with pytest.raises(ParameterError, match="wanted"):
        quick(name).load(arrays)


def test_a_plan_makes_it(name):
    asked = SupportConfig(name, nu=0.2, bandwidth_factor=0.5)
    support = make_support(name, **support_hyperparameters(asked))
    assert getattr(support, "nu", None) == 0.2
    assert getattr(support, "bandwidth_factor", 0.5) == 0.5


def test_unknown_name():
    with pytest.raises(UnknownNameError, match="one-class-svm"):
        make_support("two-class-svm")
