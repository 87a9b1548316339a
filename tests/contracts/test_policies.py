"""What every policy of the table must do, each on a toy task of what it looks at."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError, UnknownNameError
from sheath_manip.policies import POLICIES, make_policy
from sheath_manip.protocols import Policy, ScoresChoices
from sheath_manip.types import ActionSpec, Observation, TaskSpec
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
def fitted_policy(name: str) -> Policy:
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


def observation_of(samples: Samples, index: int) -> Observation:
    images = {camera: images[index] for camera, images in samples.images.items()}
    return Observation(images, samples.features[index], 0.0)


@every_policy
def test_learns_the_toy(name):
    samples = held_out(name)
    losses = fitted_policy(name).surrogate_losses(samples)
    assert losses.shape == (len(samples),)
    assert losses.dtype == np.float32
    assert losses.min() >= 0
    assert losses.max() <= 1
    agrees = losses <= toy(name).spec.action.tolerance
    assert agrees.mean() >= (0.9 if name in CONTINUOUS else 0.95)


@every_classifier
def test_the_loss_of_a_classifier_is_zero_or_one(name):
    assert set(np.unique(fitted_policy(name).surrogate_losses(held_out(name)))) <= {0.0, 1.0}


@every_regressor
def test_the_loss_of_a_regressor_is_the_worst_deviation_as_a_share_of_its_range(name):
    samples, policy, action = held_out(name), fitted_policy(name), toy(name).spec.action
    predicted = policy.predict(samples.images, samples.features)
    off = np.array([0.0, 0.03], np.float32)
    losses = policy.surrogate_losses(replace(samples, labels=predicted + off))
    np.testing.assert_allclose(losses, 0.03 / (action.maximum - action.minimum)[1], rtol=1e-4)


@every_regressor
def test_proposes_nothing_beyond_the_bounds(name):
    samples, action = held_out(name), toy(name).spec.action
    far = replace(samples, features=50 * samples.features)
    predicted = fitted_policy(name).predict(far.images, far.features)
    for one in predicted:
        action.validated(one)
    assert (predicted == action.maximum).any()


@every_regressor
def test_every_camera_and_feature_counts(name):
    samples, policy = held_out(name), fitted_policy(name)
    seen = policy.predict(samples.images, samples.features)
    for camera, images in samples.images.items():
        unseen = {**samples.images, camera: images[::-1].copy()}
        assert np.abs(policy.predict(unseen, samples.features) - seen).max() > 0.01
    assert np.abs(policy.predict(samples.images, -samples.features) - seen).max() > 0.01


@every_policy
def test_predicts_and_acts_alike(name):
    samples, policy, action = held_out(name), fitted_policy(name), toy(name).spec.action
    predicted = policy.predict(samples.images, samples.features)
    assert predicted.shape == (len(samples), len(action.names))
    assert predicted.dtype == np.float32
    for index in range(10):
        acted = policy.act(observation_of(samples, index))
        # A batch may be summed in another order than a single state.
        rounding = 1e-5 if name in CONTINUOUS else 0.0
        np.testing.assert_allclose(action.validated(acted), predicted[index], atol=rounding)


@every_classifier
def test_predicts_choices(name):
    samples = held_out(name)
    predicted = fitted_policy(name).predict(samples.images, samples.features)
    choices = toy(name).spec.action.choices
    assert (predicted[:, None] == choices).all(axis=2).any(axis=1).all()


@every_classifier
def test_predicts_the_choice_with_the_highest_score(name):
    samples, policy = held_out(name), fitted_policy(name)
    choices = toy(name).spec.action.choices
    assert choices is not None
    assert isinstance(policy, ScoresChoices)
    scores = policy.choice_scores(samples.images, samples.features)
    assert scores.shape == (len(samples), len(choices))
    predicted = policy.predict(samples.images, samples.features)
    np.testing.assert_array_equal(choices[scores.argmax(axis=1)], predicted)


@every_policy
def test_predicts_nothing_for_no_states(name):
    nothing = held_out(name).take(np.arange(0))
    width = len(toy(name).spec.action.names)
    assert fitted_policy(name).predict(nothing.images, nothing.features).shape == (0, width)


@every_policy
def test_loaded_arrays_predict_the_same(name):
    samples, policy = held_out(name), fitted_policy(name)
    loaded = make_policy(name, toy(name).spec, seed=7, **shape(name)).load(policy.arrays())
    np.testing.assert_array_equal(
        loaded.predict(samples.images, samples.features),
        policy.predict(samples.images, samples.features),
    )


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
    np.testing.assert_array_equal(policy.surrogate_losses(off), policy.surrogate_losses(samples))


@every_classifier
def test_survives_training_states_of_one_choice(name):
    samples = toy(name).samples(20, seed=4, choices=(2,))
    policy = make_policy(name, toy(name).spec, **quick(name)).fit(samples)
    assert policy.surrogate_losses(samples).mean() <= 0.1


@every_policy
def test_errors_are_clear(name):
    spec = toy(name).spec
    with pytest.raises(ParameterError, match="not fitted"):
        make_policy(name, spec).act(observation_of(held_out(name), 0))
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
