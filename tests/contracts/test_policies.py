"""What every policy of the table must do, each on a toy task of what it looks at."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.policies import POLICIES, make_policy
from sheath_manip.policies.looking import look
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.types import ActionSpec, TaskSpec
from sheath_manip.types.samples import Samples
from tests import blobs, buttons, line, reach

# Others are fitted in one stroke.
EPOCHS = {"epochs": 2}
STEPS = {"steps": 4, "warm_steps": 2}
QUICK = {
    "cnn": EPOCHS,
    "plain-cnn": EPOCHS,
    "paper-cnn": EPOCHS,
    "spatial-cnn": reach.SETTINGS | STEPS,
    "egocentric-cnn": {"spatial_settings": line.SETTINGS["spatial_settings"] | STEPS},
}
OF_FEATURES = ("linear-svm", "linear-svm-paper", "smile")
CONTINUOUS = ("spatial-cnn", "egocentric-cnn")
every_policy = pytest.mark.parametrize("name", sorted(POLICIES))
every_classifier = pytest.mark.parametrize("name", sorted(set(POLICIES) - set(CONTINUOUS)))
every_regressor = pytest.mark.parametrize("name", CONTINUOUS)


@dataclass(frozen=True)
class Toy:
    """A task and states of it."""

    spec: TaskSpec
    samples: Callable[..., Samples]
    """(count, seed), and for tasks of choices those that there are"""
    nudge: np.ndarray
    """(a,) what an action may be off by and still count as the same"""
    missing: dict[str, Any]
    """a spec without what the policy looks at"""
    complaint: str
    """what is then said"""
    another: dict[str, Any]
    """a spec for which what was learned is of no use"""
    refusal: str
    """what is then said"""


def _of_two_choices(spec: TaskSpec) -> ActionSpec:
    assert spec.action.choices is not None
    return replace(spec.action, choices=spec.action.choices[:2])


SEEN = Toy(
    blobs.SPEC,
    blobs.blob_samples,
    np.array([0.02]),
    {"cameras": {}},
    "no camera",
    {"action": _of_two_choices(blobs.SPEC)},
    r"2 choices|wanted 2",
)
PRESSED = Toy(
    buttons.SPEC,
    buttons.button_samples,
    np.full(2, 0.2),
    {"feature_names": ()},
    "no features",
    {"feature_names": buttons.SPEC.feature_names[:3]},
    r"wanted \(2, 4\)",
)
REACHED = Toy(
    reach.SPEC,
    reach.reach_samples,
    np.zeros(2),
    {"cameras": {}},
    "no camera",
    {"feature_names": reach.SPEC.feature_names[:1]},
    "1 features",
)
FOLLOWED = Toy(
    line.SPEC,
    line.line_samples,
    np.zeros(2),
    {"tool_frame": None},
    "no tool frame",
    {"feature_names": (*line.SPEC.feature_names, "force_n")},
    "2 features",
)


def toy(name: str) -> Toy:
    if name in CONTINUOUS:
        return REACHED if name == "spatial-cnn" else FOLLOWED
    return PRESSED if name in OF_FEATURES else SEEN


@cache
def held_out(name: str) -> Samples:
    return toy(name).samples(200, seed=1)


@cache
def fitted_policy(name: str) -> TrainablePolicy:
    """Fitted once for all tests, which must not fit it again."""
    if name in CONTINUOUS:
        return (reach if name == "spatial-cnn" else line).fitted_policy(name)
    if name not in OF_FEATURES:
        return blobs.fitted_policy(name)
    return make_policy(name, buttons.SPEC).fit(buttons.training())


def quick(name: str) -> dict[str, Any]:
    return QUICK.get(name, {})


def shape(name: str) -> dict[str, Any]:
    """What a policy must be given to take over what `fitted_policy` learned."""
    return {"spatial-cnn": reach.SETTINGS, "egocentric-cnn": line.SETTINGS}.get(name, {})


def predicted_by(policy: TrainablePolicy, samples: Samples) -> np.ndarray:
    return policy.predict(samples.observations).now


def losses_of(policy: TrainablePolicy, samples: Samples) -> np.ndarray:
    return policy.surrogate_losses(policy.predict(samples.observations), samples.labels)


@every_policy
def test_learns_the_toy(name):
    samples = held_out(name)
    losses = losses_of(fitted_policy(name), samples)
    assert losses.shape == (len(samples),)
    assert losses.dtype == np.float32
    assert losses.min() >= 0
    assert losses.max() <= 1
    agrees = losses <= toy(name).spec.action.tolerance
    assert agrees.mean() >= (0.9 if name in CONTINUOUS else 0.95)


@every_classifier
def test_the_loss_of_a_classifier_is_zero_or_one(name):
    assert set(np.unique(losses_of(fitted_policy(name), held_out(name)))) <= {0.0, 1.0}


@every_regressor
def test_the_loss_of_a_regressor_is_the_worst_deviation_as_a_share_of_its_range(name):
    samples, policy, action = held_out(name), fitted_policy(name), toy(name).spec.action
    proposal = policy.predict(samples.observations)
    off = np.array([0.0, 0.03], np.float32)
    losses = policy.surrogate_losses(proposal, proposal.now + off)
    np.testing.assert_allclose(losses, 0.03 / (action.maximum - action.minimum)[1], rtol=1e-4)


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


@every_policy
def test_loaded_arrays_predict_the_same(name):
    samples, policy = held_out(name), fitted_policy(name)
    loaded = make_policy(name, toy(name).spec, seed=7, **shape(name)).load(policy.arrays())
    np.testing.assert_array_equal(predicted_by(loaded, samples), predicted_by(policy, samples))


@every_policy
def test_is_repeatable_from_its_seed_also_when_refitted_from_a_file(name):
    spec, samples = toy(name).spec, toy(name).samples
    first, more = samples(40, seed=2), samples(60, seed=3)
    once = make_policy(name, spec, seed=3, **quick(name)).fit(first)
    again = make_policy(name, spec, seed=3, **quick(name)).load(once.arrays())
    once.fit(more)
    again.fit(more)
    for key, array in once.arrays().items():
        np.testing.assert_array_equal(array, again.arrays()[key])


@every_classifier
def test_labels_are_taken_as_the_nearest_choice(name):
    samples, nudge = held_out(name), toy(name).nudge.astype(np.float32)
    off = replace(samples, labels=samples.labels + nudge)
    policy = fitted_policy(name)
    np.testing.assert_array_equal(losses_of(policy, off), losses_of(policy, samples))


@every_classifier
def test_survives_training_states_of_one_choice(name):
    samples = toy(name).samples(20, seed=4, choices=(2,))
    policy = make_policy(name, toy(name).spec, **quick(name)).fit(samples)
    assert losses_of(policy, samples).mean() <= 0.1


@every_policy
def test_errors_are_clear(name):
    spec = toy(name).spec
    with pytest.raises(ParameterError, match="not fitted"):
        make_policy(name, spec).propose(held_out(name).observations.rows(slice(0, 1)))
    with pytest.raises(ParameterError, match="at least one labelled state"):
        make_policy(name, spec).fit(held_out(name).take(np.arange(0)))
    with pytest.raises(ParameterError, match=toy(name).complaint):
        make_policy(name, replace(spec, **toy(name).missing))
    with pytest.raises(UnknownNameError, match="cnn"):
        make_policy(name + "x", spec)


@every_classifier
def test_a_classifier_wants_a_list_of_actions(name):
    spec = toy(name).spec
    with pytest.raises(ParameterError, match="no list of admissible actions"):
        make_policy(name, replace(spec, action=replace(spec.action, choices=None)))


@every_policy
def test_refuses_what_was_learned_for_another_task(name):
    other = replace(toy(name).spec, **toy(name).another)
    with pytest.raises(ParameterError, match=toy(name).refusal):
        make_policy(name, other, **shape(name)).load(fitted_policy(name).arrays())
