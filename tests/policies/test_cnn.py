from dataclasses import replace

import numpy as np
import pytest
import torch

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.policies.readings import last_numbered_layer, numbered_layer
from sheath_manip.policies.reconstruction import reconstruction_loss
from tests.blobs import SPEC, blob_samples, fitted_policy, held_out


def weights(policy: ConvPolicy) -> np.ndarray:
    return np.concatenate([np.ravel(array) for array in policy.arrays().values()])


def test_a_refit_continues_from_the_present_weights():
    samples = blob_samples(60, seed=5)
    policy = ConvPolicy(SPEC, epochs=2, warm_steps=1, batch_size=20, learning_rate=1e-4)
    before = weights(policy.fit(samples))
    after = weights(policy.fit(samples))
    # One step of Adam moves no weight by much more than the learning rate.
    assert 0 < np.abs(after - before)[:-1].max() < 2e-4
    assert policy.fits_ == 2


def test_the_global_generator_is_left_alone():
    before = torch.get_rng_state()
    ConvPolicy(SPEC, epochs=1).fit(blob_samples(20, seed=6))
    assert torch.equal(torch.get_rng_state(), before)


def test_seeds_differ():
    samples = blob_samples(20, seed=7)
    first, second = (ConvPolicy(SPEC, epochs=1, seed=seed).fit(samples) for seed in (0, 1))
    assert not np.array_equal(weights(first), weights(second))


def test_activations_of_every_layer():
    five = held_out().take(np.arange(5)).observations
    proposal = fitted_policy("cnn").predict(five)
    assert [tuple(numbered_layer(proposal, number).shape) for number in range(3)] == [
        (5, 16, 30, 30),
        (5, 32, 14, 14),
        (5, 32, 6, 6),
    ]
    assert last_numbered_layer(proposal) is numbered_layer(proposal, 2)
    with pytest.raises(ParameterError, match="convolutions to look through"):
        numbered_layer(proposal, 3)
    assert tuple(proposal.latents["penultimate"].shape) == (5, 64)
    np.testing.assert_allclose(proposal.latents["choice scores"].sum(axis=1), 1, rtol=1e-5)


def test_read_only_images_give_no_warning():
    samples = blob_samples(20, seed=8)
    samples.images["top"].flags.writeable = False
    policy = ConvPolicy(SPEC, epochs=1).fit(samples)
    policy.predict(samples.observations)
    policy.propose(samples.observations.rows(slice(0, 1)))


def test_shapes_that_cannot_be():
    samples = blob_samples(2, seed=9)
    with pytest.raises(ParameterError, match="too small"):
        ConvPolicy(replace(SPEC, cameras={"top": (20, 20)})).fit(samples)
    with pytest.raises(ParameterError, match="4 convolution layers"):
        ConvPolicy(SPEC, channels=(8, 8, 8, 8)).fit(samples)
    with pytest.raises(ParameterError, match="not those of a network"):
        ConvPolicy(SPEC, hidden=(8,)).load(fitted_policy("cnn").arrays())


def test_the_image_is_painted_back_better_with_every_fit():
    samples = blob_samples(100, seed=10)
    policy = ConvPolicy(SPEC, epochs=1, batch_size=20, warm_steps=60)

    def painting_loss() -> float:
        network = policy.network_
        last = last_numbered_layer(policy.predict(samples.observations))
        assert network is not None
        assert network.decoder is not None
        with torch.inference_mode():
            pictures = network.decoder(last)
            assert tuple(pictures.shape) == (100, 3, 24, 24)
            return float(reconstruction_loss(pictures, torch.from_numpy(samples.images["top"])))

    policy.fit(samples)
    first = painting_loss()
    policy.load(policy.arrays())
    assert painting_loss() == first
    policy.fit(samples)
    assert painting_loss() < 0.7 * first


def test_at_weight_0_nothing_is_painted_and_the_rest_begins_the_same():
    samples = blob_samples(20, seed=11)
    painting, plain = (
        ConvPolicy(SPEC, epochs=1, learning_rate=0.0, reconstruction_weight=weight).fit(samples)
        for weight in (1.0, 0.0)
    )
    decoder = {name for name in painting.arrays() if name.startswith("decoder.")}
    assert decoder
    assert set(plain.arrays()) == set(painting.arrays()) - decoder
    for name, array in plain.arrays().items():
        np.testing.assert_array_equal(array, painting.arrays()[name])
    with pytest.raises(ParameterError, match="reconstruction weight 0"):
        ConvPolicy(SPEC, reconstruction_weight=0.0).load(painting.arrays())


@pytest.mark.parametrize("name", ["paper-cnn", "plain-cnn"])
def test_the_drafts_network_and_the_plain_one_paint_nothing(name):
    assert not any(key.startswith("decoder.") for key in fitted_policy(name).arrays())


def test_an_untrained_policy_has_the_shape_and_the_seeds_weights():
    policy = ConvPolicy(SPEC, channels=(4, 8), hidden=(16,), seed=1)
    five = held_out().take(np.arange(5)).observations
    looks = [policy.untrained(seed).predict(five) for seed in (2, 2, 3)]
    assert [numbered_layer(looks[0], number).shape[1] for number in (0, 1)] == [4, 8]
    first, again, other = map(last_numbered_layer, looks)
    assert torch.equal(first, again)
    assert not torch.equal(first, other)
