"""What every policy of the table must do."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.policies import POLICIES, make_policy
from tests.blobs import CHOICES, SPEC, blob_samples, fitted_policy, held_out, observation_of

pytestmark = pytest.mark.parametrize("name", sorted(POLICIES))


def test_learns_the_blobs(name):
    samples = held_out()
    losses = fitted_policy(name).surrogate_losses(samples)
    assert losses.shape == (len(samples),)
    assert set(np.unique(losses)) <= {0.0, 1.0}
    assert losses.mean() <= 0.05


def test_predicts_choices_and_acts_alike(name):
    samples, policy = held_out(), fitted_policy(name)
    predicted = policy.predict(samples.images, samples.features)
    assert predicted.shape == (len(samples), 1)
    assert predicted.dtype == np.float32
    assert np.isin(predicted, CHOICES).all()
    for index in range(10):
        action = policy.act(observation_of(samples, index))
        assert SPEC.action.validated(action).tolist() == predicted[index].tolist()


def test_predicts_nothing_for_no_images(name):
    nothing = held_out().take(np.arange(0))
    assert fitted_policy(name).predict(nothing.images, nothing.features).shape == (0, 1)


def test_loaded_arrays_predict_the_same(name):
    samples, policy = held_out(), fitted_policy(name)
    loaded = make_policy(name, SPEC, seed=7).load(policy.arrays())
    np.testing.assert_array_equal(
        loaded.predict(samples.images, samples.features),
        policy.predict(samples.images, samples.features),
    )


def test_is_repeatable_from_its_seed_also_when_refitted_from_a_file(name):
    first, more = blob_samples(40, seed=2), blob_samples(60, seed=3)
    hyper = {} if name == "hog-svm" else {"epochs": 2}
    once = make_policy(name, SPEC, seed=3, **hyper).fit(first)
    again = make_policy(name, SPEC, seed=3, **hyper).load(once.arrays())
    once.fit(more)
    again.fit(more)
    for key, array in once.arrays().items():
        np.testing.assert_array_equal(array, again.arrays()[key])


def test_labels_are_taken_as_the_nearest_choice(name):
    samples = held_out()
    off = replace(samples, labels=samples.labels + np.float32(0.02))
    policy = fitted_policy(name)
    np.testing.assert_array_equal(policy.surrogate_losses(off), policy.surrogate_losses(samples))


def test_survives_training_states_of_one_choice(name):
    hyper = {} if name == "hog-svm" else {"epochs": 2}
    samples = blob_samples(20, seed=4, choices=(2,))
    policy = make_policy(name, SPEC, **hyper).fit(samples)
    assert policy.surrogate_losses(samples).mean() <= 0.1


def test_errors_are_clear(name):
    with pytest.raises(ParameterError, match="not fitted"):
        make_policy(name, SPEC).act(observation_of(held_out(), 0))
    with pytest.raises(ParameterError, match="at least one labelled state"):
        make_policy(name, SPEC).fit(held_out().take(np.arange(0)))
    with pytest.raises(ParameterError, match="no list of admissible actions"):
        make_policy(name, replace(SPEC, action=replace(SPEC.action, choices=None)))
    with pytest.raises(ParameterError, match="no camera"):
        make_policy(name, replace(SPEC, cameras={}))
    other = make_policy(name, replace(SPEC, action=replace(SPEC.action, choices=CHOICES[:2])))
    with pytest.raises(ParameterError, match=r"2 choices|wanted 2"):
        other.load(fitted_policy(name).arrays())
    with pytest.raises(UnknownNameError, match="cnn"):
        make_policy(name + "x", SPEC)
