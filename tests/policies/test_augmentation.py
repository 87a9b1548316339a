"""Mirror images of states."""

from dataclasses import replace

import numpy as np

from sheath_manip.policies import make_policy
from sheath_manip.policies.augmentation import half_of_them, reflected
from sheath_manip.types import Mirror
from tests import reach

MIRROR = Mirror(features=(-1.0, 1.0), action=(-1.0, 1.0))


def test_half_of_the_states_become_their_mirror_images_and_the_rest_stay():
    samples = reach.held_out()
    turned = half_of_them(len(samples), MIRROR, np.random.default_rng(0))
    assert 0.35 < turned.mean() < 0.65
    mirrored = reflected(samples, MIRROR, turned)
    sign = np.where(turned, -1, 1)
    for array, original in (
        (mirrored.features, samples.features),
        (mirrored.labels, samples.labels),
    ):
        np.testing.assert_array_equal(array[:, 0], sign * original[:, 0])
        np.testing.assert_array_equal(array[:, 1], original[:, 1])
    # Images are turned where they are shown.
    assert not mirrored.images


def test_without_a_mirror_all_stay():
    samples = reach.held_out()
    turned = half_of_them(len(samples), None, np.random.default_rng(0))
    assert not turned.any()
    np.testing.assert_array_equal(reflected(samples, None, turned).labels, samples.labels)


def test_the_policy_learns_from_both_sides():
    spec = replace(reach.SPEC, mirror=MIRROR)
    right = reach.training().labels[:, 0] > 0
    policy = make_policy("spatial-cnn", spec, **reach.SETTINGS).fit(reach.training().take(right))
    held_out = reach.held_out()
    left = held_out.labels[:, 0] < -0.05
    predicted = policy.predict(held_out.observations).now[left, 0]
    assert (predicted < 0).mean() > 0.9
