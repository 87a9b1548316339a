from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies import make_embedding
from sheath_manip.policies.side_by_side import SideBySide
from tests.blobs import fitted_policy, training


class Scaled:
    """An embedding that gives the features, enlarged."""

    def __init__(self, factor: float) -> None:
        self.factor = factor

    def fit(self, policy, samples):
        del policy, samples
        return self

    def transform(self, images, features):
        del images
        return np.asarray(features * self.factor, np.float32)


def samples_with_features():
    rng = np.random.default_rng(0)
    samples = training()
    return replace(samples, features=rng.normal(size=(len(samples), 4)).astype(np.float32))


def side_by_side(factor: float, **weights: float) -> SideBySide:
    parts = {"small": Scaled(1.0), "large": Scaled(factor)}
    return SideBySide(parts, weights)  # pyright: ignore[reportArgumentType]


def test_a_part_counts_by_its_weight_whatever_its_size():
    samples = samples_with_features()
    vectors = [
        side_by_side(factor, small=1.0, large=2.0)
        .fit(fitted_policy("hog-svm"), samples)
        .transform(samples.images, samples.features)
        for factor in (1.0, 100.0)
    ]
    np.testing.assert_allclose(vectors[0], vectors[1], rtol=1e-4)
    small, large = np.split(vectors[0].astype(np.float64), 2, axis=1)
    assert small.var(axis=0).sum() == pytest.approx(1, rel=1e-3)
    assert large.var(axis=0).sum() == pytest.approx(2, rel=1e-3)


def test_what_never_moves_says_nothing():
    samples = samples_with_features()
    still = side_by_side(0.0, small=1.0, large=2.0).fit(fitted_policy("hog-svm"), samples)
    assert np.isfinite(still.transform(samples.images, samples.features)).all()


@pytest.mark.parametrize("weights", [{"small": 1.0}, {"small": 1.0, "large": 0.0}])
def test_every_part_wants_a_weight(weights):
    with pytest.raises(ParameterError, match="wanted one above 0 for each"):
        side_by_side(1.0, **weights)


def test_the_default_sees_through_the_policy():
    samples = training()
    embedding = make_embedding("convolutions-and-pixels").fit(fitted_policy("cnn"), samples)
    other = make_embedding("convolutions-and-pixels").fit(fitted_policy("plain-cnn"), samples)
    one = samples.take(np.arange(3))
    first, second = (e.transform(one.images, one.features) for e in (embedding, other))
    # The last numbers are the pixels', which know no policy.
    np.testing.assert_allclose(first[:, -768:], second[:, -768:], rtol=1e-5)
    assert first.shape[1] > 768
