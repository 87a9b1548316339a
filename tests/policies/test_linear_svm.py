from dataclasses import replace

import numpy as np
import pytest
from sklearn.svm import LinearSVC

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies import make_policy
from sheath_manip.policies.linear_svm import PENALTIES, PENALTY_UNTRIED, LinearSvm
from sheath_manip.policies.squared_hinge import squared_hinge_weights
from sheath_manip.types import Observation
from sheath_manip.types.samples import Samples
from tests.buttons import CHOICES, SPEC, button_samples


def noisy(count: int, seed: int, rate: float = 0.2) -> tuple[np.ndarray, np.ndarray]:
    """Binary rows with a column of ones, and signs of which a share is wrong."""
    rng = np.random.default_rng(seed)
    rows = np.column_stack([rng.random((count, 60)) < 0.3, np.ones(count)]).astype(np.float64)
    signs = np.sign(rows[:, :10].sum(axis=1) - rows[:, 10:20].sum(axis=1) + 0.5)
    return rows, np.where(rng.random(count) < rate, -signs, signs)


@pytest.mark.parametrize("penalty", [0.001, 0.01, 0.1, 1.0, 10.0])
def test_the_machine_is_liblinears(penalty):
    rows, signs = noisy(500, seed=0)
    weights = squared_hinge_weights(rows, signs, penalty)
    # sklearn's stubs know only "auto".
    reference = LinearSVC(C=penalty, dual=False, tol=1e-8, max_iter=10_000)  # pyright: ignore[reportArgumentType]
    reference.fit(rows[:, :-1], signs)
    expected = np.append(reference.coef_[0], reference.intercept_)
    np.testing.assert_allclose(weights, expected, atol=1e-4)


def test_where_it_begins_does_not_matter():
    rows, signs = noisy(400, seed=1)
    cold = squared_hinge_weights(rows, signs, 0.1)
    begin = squared_hinge_weights(rows[:300], signs[:300], 0.1)
    np.testing.assert_allclose(squared_hinge_weights(rows, signs, 0.1, begin), cold, atol=1e-9)


def test_c_is_chosen_once_by_held_out_episodes_and_kept():
    policy = LinearSvm(SPEC).fit(button_samples(200, seed=0))
    assert policy.penalty_ in PENALTIES
    chosen = policy.penalty_
    loaded = LinearSvm(SPEC).load(policy.arrays()).fit(button_samples(100, seed=5))
    assert loaded.penalty_ == chosen


def test_noise_asks_for_a_smaller_c_than_none():
    rng = np.random.default_rng(0)
    bits = (rng.random((300, len(SPEC.feature_names))) < 0.5).astype(np.float32)
    sure = np.where(bits[:, :1] > 0, CHOICES[1], CHOICES[2])
    flipped = np.where(rng.random((300, 1)) < 0.3, 1 - sure, sure)
    episodes = np.arange(300) // 30
    clean, noise = (
        LinearSvm(SPEC).fit(Samples({}, bits, labels, episodes)) for labels in (sure, flipped)
    )
    assert noise.penalty_ <= clean.penalty_
    assert noise.penalty_ < PENALTIES[-1]


def test_one_episode_takes_a_c_untried():
    assert LinearSvm(SPEC).fit(button_samples(40, seed=0)).penalty_ == PENALTY_UNTRIED
    of_the_paper = make_policy("linear-svm-paper", SPEC).fit(button_samples(200, seed=0))
    assert of_the_paper.arrays()["penalty"] == 0.01


def test_of_two_buttons_that_exclude_each_other_the_surer_is_pressed():
    width = len(SPEC.feature_names)
    machines = np.zeros((2, width + 1))
    policy = LinearSvm(SPEC).load({"machines": machines, "penalty": np.array(0.1)})
    observation = Observation({}, np.zeros(width, np.float32), 0.0)
    for biases, wanted in (
        ((2.0, 1.0), [1, 0]),
        ((1.0, 2.0), [0, 1]),
        ((-1.0, -2.0), [0, 0]),
        ((-1.0, 2.0), [0, 1]),
    ):
        machines[:, -1] = biases
        policy.load({"machines": machines, "penalty": np.array(0.1)})
        assert policy.propose(observation.alone).now[0].tolist() == wanted


def test_a_button_that_was_never_pressed_is_never_pressed():
    policy = LinearSvm(SPEC).fit(button_samples(100, seed=0, choices=(0, 1)))
    samples = button_samples(100, seed=1)
    assert (policy.predict(samples.observations).now[:, 1] == 0).all()


def test_actions_between_the_bounds_are_no_buttons():
    action = replace(SPEC.action, choices=np.array([[0, 0], [0.5, 1]], np.float32))
    with pytest.raises(ParameterError, match="wanted buttons"):
        LinearSvm(replace(SPEC, action=action))
