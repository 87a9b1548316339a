import numpy as np
import pytest
from scipy.spatial.distance import pdist

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.scaling import Standardisation, Whitening


@pytest.fixture
def vectors() -> np.ndarray:
    """Correlated, of very different units."""
    rng = np.random.default_rng(0)
    return rng.normal(size=(2000, 6)) @ rng.normal(size=(6, 6)) * [1, 2, 3, 1, 2, 1] + 5


def test_standardised_vectors_have_zero_mean_and_unit_deviation(vectors):
    scaled = Standardisation().fit(vectors).transform(vectors)
    assert scaled.dtype == np.float32
    np.testing.assert_allclose(scaled.mean(axis=0), 0, atol=1e-5)
    np.testing.assert_allclose(scaled.std(axis=0), 1, rtol=1e-4)


def test_a_feature_that_never_moved_is_not_magnified_without_bound(vectors):
    vectors[:, 0] = 0.25
    vectors[:, 1] *= 1e-9
    scaling = Standardisation().fit(vectors)
    moved = scaling.transform(vectors[:1] + 0.1 * vectors.std(axis=0).max())
    assert np.isfinite(moved).all()
    assert np.abs(moved).max() < 50


def test_constant_vectors_can_be_scaled():
    assert (Standardisation().fit(np.ones((5, 3))).transform(np.ones((2, 3))) == 0).all()


def test_whitened_vectors_are_uncorrelated(vectors):
    white = Whitening().fit(vectors).transform(vectors)
    np.testing.assert_allclose(np.cov(white.T), np.eye(6), atol=0.2)


def test_whitening_copes_with_fewer_states_than_dimensions():
    vectors = np.random.default_rng(1).normal(size=(20, 50))
    vectors[:, 0] = 1
    white = Whitening().fit(vectors).transform(vectors)
    assert np.isfinite(white).all()


@pytest.mark.parametrize("scaling", [Standardisation, Whitening])
def test_loaded_arrays_scale_the_same(scaling, vectors):
    fitted = scaling().fit(vectors)
    loaded = scaling().load(fitted.arrays())
    np.testing.assert_array_equal(loaded.transform(vectors), fitted.transform(vectors))


@pytest.mark.parametrize("wrong", [np.zeros((0, 3)), np.zeros(3), np.full((2, 3), np.nan)])
@pytest.mark.parametrize("scaling", [Standardisation, Whitening])
def test_vectors_that_cannot_be_scaled(scaling, wrong):
    with pytest.raises(ParameterError, match="wanted finite"):
        scaling().fit(wrong)


def test_of_the_whitened_directions_the_widest_are_kept(vectors):
    every = Whitening().fit(vectors).transform(vectors)
    few = Whitening(most=2).fit(vectors).transform(vectors)
    assert few.shape == (len(vectors), 2)
    # With all of them it is the same but for a turn, and fewer are never farther apart.
    turned = Whitening(most=vectors.shape[1]).fit(vectors).transform(vectors)
    apart = {name: pdist(each) for name, each in (("all", every), ("turned", turned))}
    np.testing.assert_allclose(apart["turned"], apart["all"], rtol=1e-3, atol=1e-4)
    assert (pdist(few) <= apart["all"] + 1e-4).all()
    standardised = Standardisation().fit(vectors).transform(vectors)
    widest = np.linalg.svd(standardised, full_matrices=False)[2][0]
    along = np.corrcoef(standardised @ widest, few[:, -1])[0, 1]
    assert abs(along) > 0.999


def test_at_least_one_direction_is_kept():
    with pytest.raises(ParameterError, match="most is 0; wanted at least one direction"):
        Whitening(most=0)
