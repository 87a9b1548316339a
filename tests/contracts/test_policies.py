"""What every policy must propose and predict, each on a toy task of what it looks at."""

from dataclasses import replace

import numpy as np

from sheath_manip.policies.looking import look
from sheath_manip.protocols import Replans
from tests.contracts.policy_toys import (
    CONTINUOUS,
    every_classifier,
    every_policy,
    every_regressor,
    fitted_policy,
    held_out,
    losses_of,
    predicted_by,
    toy,
)


@every_regressor
def test_proposes_nothing_beyond_the_bounds(name):
    samples, action = held_out(name), toy(name).spec.action
    far = replace(samples, features=50 * samples.features)
    predicted = predicted_by(fitted_policy(name), far)
    for one in predicted:
        action.validated(one)
    assert (predicted == action.maximum).any()


@every_regressor
def test_every_camera_and_feature_counts(name):
    samples, policy = held_out(name), fitted_policy(name)
    seen = predicted_by(policy, samples)
    for camera, images in samples.images.items():
        unseen = {**samples.images, camera: images[::-1].copy()}
        assert np.abs(predicted_by(policy, replace(samples, images=unseen)) - seen).max() > 0.01
    turned = replace(samples, features=-samples.features)
    assert np.abs(predicted_by(policy, turned) - seen).max() > 0.01


@every_policy
def test_proposes_in_one_state_what_it_predicts_among_many(name):
    samples, policy, action = held_out(name), fitted_policy(name), toy(name).spec.action
    predicted = policy.predict(samples.observations)
    assert predicted.now.shape == (len(samples), len(action.names))
    assert predicted.now.dtype == np.float32
    policy.reset(np.random.default_rng(0))
    for index in range(10):
        alone = samples.observations.rows(slice(index, index + 1))
        if isinstance(policy, Replans):
            policy.replan()
        proposal = policy.propose(alone)
        assert proposal.now.shape == (1, len(action.names))
        # A batch may be summed in another order than a single state.
        rounding = 1e-5 if name in CONTINUOUS else 0.0
        proposed = action.validated(proposal.now[0])
        np.testing.assert_allclose(proposed, predicted.now[index], atol=rounding)


@every_policy
def test_a_proposal_and_a_prediction_have_the_same_latents(name):
    """A signal that was fitted to predictions judges proposals."""
    samples, policy = held_out(name), fitted_policy(name)
    predicted = policy.predict(samples.observations)
    proposal = policy.propose(samples.observations.rows(slice(0, 1)))
    assert proposal.latents.keys() == predicted.latents.keys()
    for latent, of_all in predicted.latents.items():
        # Those that are a mapping are images by camera.
        pairs = [(proposal.latents[latent], of_all)]
        if isinstance(of_all, dict):
            pairs = [(proposal.latents[latent][camera], of_all[camera]) for camera in of_all]
        for one, each in pairs:
            assert len(each) == len(samples)
            np.testing.assert_allclose(np.asarray(one)[0], np.asarray(each)[0], atol=1e-4)


@every_policy
def test_predicting_draws_nothing(name):
    policy, rng = fitted_policy(name), np.random.default_rng(5)
    policy.reset(rng)
    first = policy.predict(held_out(name).observations)
    again = policy.predict(held_out(name).observations)
    np.testing.assert_array_equal(first.now, again.now)
    assert rng.random() == np.random.default_rng(5).random()


@every_policy
def test_a_look_in_batches_is_as_the_whole(name):
    samples, policy = held_out(name), fitted_policy(name)
    labels = samples.labels.copy()
    labels[3] = np.nan
    seen = look(policy, replace(samples, labels=labels))
    assert len(seen) == len(samples) > 128
    np.testing.assert_allclose(seen.actions, predicted_by(policy, samples), atol=1e-5)
    np.testing.assert_array_equal(seen.features, samples.features)
    assert seen.losses is not None
    assert np.flatnonzero(np.isnan(seen.losses)).tolist() == [3]
    others = np.arange(len(samples)) != 3
    np.testing.assert_allclose(seen.losses[others], losses_of(policy, samples)[others], atol=1e-4)


@every_classifier
def test_predicts_choices(name):
    samples = held_out(name)
    predicted = predicted_by(fitted_policy(name), samples)
    choices = toy(name).spec.action.choices
    assert (predicted[:, None] == choices).all(axis=2).any(axis=1).all()


@every_classifier
def test_predicts_the_choice_with_the_highest_score(name):
    samples, policy = held_out(name), fitted_policy(name)
    choices = toy(name).spec.action.choices
    assert choices is not None
    proposal = policy.predict(samples.observations)
    scores = proposal.latents["choice scores"]
    assert scores.shape == (len(samples), len(choices))
    np.testing.assert_array_equal(choices[scores.argmax(axis=1)], proposal.now)


@every_policy
def test_predicts_nothing_for_no_states(name):
    nothing = held_out(name).take(np.arange(0))
    width = len(toy(name).spec.action.names)
    assert predicted_by(fitted_policy(name), nothing).shape == (0, width)
    seen = look(fitted_policy(name), nothing)
    assert len(seen) == 0
    assert seen.losses is not None
    assert seen.losses.shape == (0,)
