from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies import make_embedding
from sheath_manip.policies.pixels import Pixels
from sheath_manip.policies.side_by_side import SideBySide
from sheath_manip.protocols import Embedding
from sheath_manip.types import Observations, Proposal
from sheath_manip.types.samples import Samples
from tests.blobs import fitted_policy, training
from tests.looks import fitted_embedding, vectors_of


class Scaled:
    """An embedding that gives the features, enlarged."""

    uses_displaced = False

    def __init__(self, factor: float) -> None:
        self.factor = factor

    def attach(self, policy):
        del policy
        return ()

    def fit(self, seen):
        del seen
        return self

    def transform(self, seen):
        return np.asarray(seen.features * self.factor, np.float32)


def samples_with_features() -> Samples:
    rng = np.random.default_rng(0)
    samples = training()
    return replace(samples, features=rng.normal(size=(len(samples), 4)).astype(np.float32))


def side_by_side(factor: float, **weights: float) -> Embedding:
    parts = {"small": Scaled(1.0), "large": Scaled(factor)}
    return SideBySide(parts, weights)  # pyright: ignore[reportArgumentType]


def fitted_vectors(embedding: Embedding, samples: Samples) -> np.ndarray:
    policy = fitted_policy("hog-svm")
    return vectors_of(fitted_embedding(embedding, policy, samples), policy, samples)


def test_a_part_counts_by_its_weight_whatever_its_size():
    samples = samples_with_features()
    vectors = [
        fitted_vectors(side_by_side(factor, small=1.0, large=2.0), samples)
        for factor in (1.0, 100.0)
    ]
    np.testing.assert_allclose(vectors[0], vectors[1], rtol=1e-4)
    small, large = np.split(vectors[0].astype(np.float64), 2, axis=1)
    assert small.var(axis=0).sum() == pytest.approx(1, rel=1e-3)
    assert large.var(axis=0).sum() == pytest.approx(2, rel=1e-3)


def test_what_never_moves_says_nothing():
    samples = samples_with_features()
    assert np.isfinite(fitted_vectors(side_by_side(0.0, small=1.0, large=2.0), samples)).all()


@pytest.mark.parametrize("weights", [{"small": 1.0}, {"small": 1.0, "large": 0.0}])
def test_every_part_wants_a_weight(weights):
    with pytest.raises(ParameterError, match="wanted one above 0 for each"):
        side_by_side(1.0, **weights)


def test_convolutions_and_pixels_see_through_the_policy():
    samples = training()
    first, second = (
        vectors_of(
            fitted_embedding(make_embedding("convolutions-and-pixels"), policy, samples),
            policy,
            samples.take(np.arange(3)),
        )
        for policy in (fitted_policy("cnn"), fitted_policy("plain-cnn"))
    )
    # The last numbers are the pixels', which know no policy.
    np.testing.assert_allclose(first[:, -768:], second[:, -768:], rtol=1e-5)
    assert first.shape[1] > 768


def test_pixels_of_the_middle():
    image = np.zeros((1, 20, 20, 3), np.uint8)
    image[:, 5:15, 5:15] = 255
    observations = Observations({"top": image}, np.zeros((1, 1), np.float32))
    (reader,) = Pixels(side=4, middle=0.5).attach(fitted_policy("hog-svm"))
    assert reader(observations, Proposal(np.zeros((1, 1), np.float32))).tolist() == [[1.0] * 48]
    for side, middle in ((0, 1.0), (4, 0.0), (4, 1.5)):
        with pytest.raises(ParameterError, match="wanted at least 1 px"):
            Pixels(side=side, middle=middle)
