import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.contrast_whitening import ContrastWhitening
from sheath_manip.policies.scaling import Whitening

RNG = np.random.default_rng(0)
MIX = RNG.normal(size=(6, 6)) * [1, 2, 3, 1, 2, 1]
# What stands out when displaced: three times as wide in the first direction, moved in the second.
NATURAL = RNG.normal(size=(4000, 6))
DISPLACED = RNG.normal(size=(3000, 6)) * [3, 1, 1, 1, 0.5, 0.5] + [0, 4, 0, 0, 0, 0]


def fitted() -> ContrastWhitening:
    return ContrastWhitening().fit(NATURAL @ MIX + 5, DISPLACED @ MIX + 5)


def test_directions_that_displacement_does_not_widen_are_dropped():
    scaling = fitted()
    assert 2 <= scaling.matrix_.shape[1] <= 4
    assert scaling.transform(np.zeros((7, 6))).shape == (7, scaling.matrix_.shape[1])
    assert scaling.transform(np.zeros((7, 6))).dtype == np.float32
    middle = scaling.transform(np.full((1, 6), 5.0))

    def reach(direction: int) -> float:
        point = 3 * np.eye(6)[direction] @ MIX + 5
        return float(np.linalg.norm(scaling.transform(point[None]) - middle))

    wide = [reach(direction) for direction in (0, 1)]
    alike = [reach(direction) for direction in (2, 3, 4, 5)]
    assert min(wide) > 2.5
    assert max(alike) < 1


def test_the_directions_of_most_contrast_are_kept():
    all_of_them, one = (
        fitted(),
        ContrastWhitening(most=1).fit(NATURAL @ MIX + 5, DISPLACED @ MIX + 5),
    )
    np.testing.assert_array_equal(one.matrix_, all_of_them.matrix_[:, -1:])
    many = ContrastWhitening(most=9).fit(NATURAL @ MIX + 5, DISPLACED @ MIX + 5)
    np.testing.assert_array_equal(many.matrix_, all_of_them.matrix_)
    with pytest.raises(ParameterError, match="wanted at least one direction"):
        ContrastWhitening(most=0)


def test_the_squared_length_is_twice_the_log_likelihood_ratio():
    scaling = fitted()
    points = NATURAL[:50] @ MIX + 5
    z = Whitening().fit(NATURAL @ MIX + 5).transform(points).astype(float)
    w = Whitening().fit(NATURAL @ MIX + 5).transform(DISPLACED @ MIX + 5).astype(float)
    values, vectors = np.linalg.eigh(w.T @ w / len(w))
    wider = values > 1
    along = (z @ vectors[:, wider]) ** 2
    twice_ratio = (along - along / values[wider]).sum(axis=1)
    lengths = (scaling.transform(points).astype(float) ** 2).sum(axis=1)
    np.testing.assert_allclose(lengths, twice_ratio, atol=0.05)


def test_loaded_arrays_scale_the_same():
    scaling = fitted()
    loaded = ContrastWhitening().load(scaling.arrays())
    np.testing.assert_array_equal(loaded.transform(DISPLACED), scaling.transform(DISPLACED))


def test_without_any_contrast_it_whitens():
    vectors = NATURAL @ MIX
    scaling = ContrastWhitening().fit(vectors, vectors.mean(axis=0) + 0.1 * (vectors[:500]))
    np.testing.assert_array_equal(scaling.matrix_, Whitening().fit(vectors).matrix_)


@pytest.mark.parametrize(
    "wrong", [None, np.zeros((0, 6)), np.zeros(6), np.zeros((3, 5)), np.full((2, 6), np.nan)]
)
def test_displaced_vectors_that_are_none(wrong):
    with pytest.raises(ParameterError, match=r"\(m > 0, 6\)"):
        ContrastWhitening().fit(NATURAL, wrong)
