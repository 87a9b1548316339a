import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.hog_svm import HogSvm
from tests.blobs import SPEC, blob_samples


@pytest.mark.parametrize("choices", [(0, 2), (1, 2)])
def test_two_choices_share_one_hyperplane(choices):
    policy = HogSvm(SPEC).fit(blob_samples(80, seed=0, choices=choices))
    held_out = blob_samples(60, seed=1, choices=choices)
    losses = policy.surrogate_losses(policy.predict(held_out.observations), held_out.labels)
    assert losses.mean() <= 0.05


def test_the_gradients_are_900_numbers():
    samples = blob_samples(3, seed=2)
    gradients = HogSvm(SPEC).gradients(samples.images)
    assert gradients.shape == (3, 900)
    assert gradients.dtype == np.float32


def test_a_picture_smaller_than_a_block():
    with pytest.raises(ParameterError, match="at least two cells"):
        HogSvm(SPEC, side=16, cell=12)
