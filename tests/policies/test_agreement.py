"""Where a policy is right, judged by fits to other episodes."""

from dataclasses import dataclass, replace
from functools import partial
from typing import Self, cast

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies import make_policy
from sheath_manip.policies.agreement import held_out_agreement
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.signals import SignalChoice, make_signal
from sheath_manip.signals.support import SupportSignal
from sheath_manip.support.loss_aware_svm import LossAwareSupport
from sheath_manip.types import Observations, Proposal
from sheath_manip.types.samples import Samples
from tests.blobs import SPEC, blob_samples, fitted_policy
from tests.looks import fitted_signal

EPISODES = np.repeat([3, 1, 7, 4, 5], [10, 20, 5, 15, 10])


@dataclass
class Rote:
    """Knows the labels of the states that it saw, and no others; fits are counted."""

    fits: list[set[int]]

    def fit(self, samples: Samples) -> Self:
        self.seen = set(samples.features[:, 0].tolist())
        self.fits.append(set(samples.episodes.tolist()))
        return self

    def predict(self, observations: Observations) -> Proposal:
        known = [feature in self.seen for feature in observations.features[:, 0].tolist()]
        return Proposal(np.where(known, 0, 0.3)[:, None])

    def surrogate_losses(self, proposal: Proposal, labels: np.ndarray) -> np.ndarray:
        return np.abs(proposal.now - labels)[:, 0]


def states(features: np.ndarray) -> Samples:
    images = np.zeros((len(EPISODES), 1, 1, 3), np.uint8)
    labels = np.zeros((len(EPISODES), 1), np.float32)
    return Samples({"top": images}, features[:, None], labels, EPISODES)


def agreement(samples: Samples, **options) -> tuple[np.ndarray, list[set[int]]]:
    fits: list[set[int]] = []
    return held_out_agreement(lambda: cast(TrainablePolicy, Rote(fits)), samples, **options), fits


@pytest.mark.parametrize("folds", [2, 3, 10])
def test_no_state_is_judged_by_a_fit_that_saw_its_episode(folds):
    own = EPISODES.astype(np.float32)
    agrees, fits = agreement(states(own), folds=folds)
    assert agrees.dtype == np.bool_
    assert not agrees.any()
    assert len(fits) == min(folds, 5)
    held_out = [{1, 3, 4, 5, 7} - seen for seen in fits]
    assert sorted(episode for fold in held_out for episode in fold) == [1, 3, 4, 5, 7]


def test_a_state_met_in_other_episodes_too_is_known():
    shared = np.where(EPISODES < 5, 0, EPISODES).astype(np.float32)
    agrees, _ = agreement(states(shared))
    assert np.array_equal(agrees, EPISODES < 5)


def test_the_tolerance_is_a_loss():
    own = EPISODES.astype(np.float32)
    assert agreement(states(own), tolerance=0.3)[0].all()
    assert not agreement(states(own), tolerance=0.29)[0].any()


def test_what_cannot_be_held_out():
    samples = states(EPISODES.astype(np.float32))
    with pytest.raises(ParameterError, match=r"1 episodes .* wanted at least 2"):
        agreement(replace(samples, episodes=np.zeros(len(samples), np.int64)))
    with pytest.raises(ParameterError, match="folds is 1; wanted at least 2"):
        agreement(samples, folds=1)
    with pytest.raises(ParameterError, match="tolerance is nan; wanted"):
        agreement(samples, tolerance=float("nan"))


def test_a_signal_asks_for_it_only_where_the_support_uses_it():
    policy, training = fitted_policy("hog-svm"), blob_samples(200, seed=5)
    # An episode whose expert does what none of the others explains.
    odd = training.episodes == 2
    labels = training.labels.copy()
    labels[odd] = -labels[odd]
    training = replace(training, labels=labels)
    plain = SignalChoice("support", "pixels", "one-class-svm", "pixels")
    fits = []

    def fresh() -> TrainablePolicy:
        fits.append(1)
        return make_policy("hog-svm", SPEC)

    judge = partial(held_out_agreement, fresh, training)
    fitted_signal(make_signal(plain), policy, training, judge)
    assert not fits
    aware = replace(plain, support="loss-aware-svm")
    with pytest.raises(ParameterError, match="wanted `agreement`"):
        fitted_signal(make_signal(aware), policy, training)
    signal = fitted_signal(make_signal(aware), policy, training, judge)
    assert len(fits) == 3
    assert isinstance(signal, SupportSignal)
    assert isinstance(signal.support, LossAwareSupport)
    assert (signal.support.kernel_sum_.weights < 0).any()
