"""A single state, as a robot's step asks for one, scores as it does among many, to the bit."""

import numpy as np

from sheath_manip.signals.joined import JoinedSignal, Reference
from sheath_manip.types import Reason
from tests.feature_signal import FeatureSignal

SCORES = np.sort(np.random.default_rng(0).normal(size=500))


def test_its_rarity():
    reference = Reference.of(SCORES)
    asked = np.array([-np.inf, -40.0, *SCORES[:3], 0.0, SCORES[-1], 9.0, np.inf, np.nan])
    together = reference.log_share(asked)
    alone = [reference.log_share_of_one(score) for score in asked.tolist()]
    np.testing.assert_array_equal(alone, together)
    shares = [reference.share(score) for score in asked[:-1].tolist()]
    np.testing.assert_array_equal(shares, SCORES.searchsorted(asked[:-1]) / len(SCORES))


def test_its_joined_score():
    signal = JoinedSignal(
        {"support": FeatureSignal(0, Reason.OUTSIDE), "trust": FeatureSignal(1)},
        {"support": 1.0, "trust": 4.0},
    )
    rng = np.random.default_rng(1)
    signal.calibrate([rng.normal(size=(2000, 2))])
    measures = np.concatenate([2 * rng.normal(size=(50, 2)), [[np.nan, 0.0]]])
    together = signal.scores(measures)
    alone = [float(signal.scores(each[None])[0]) for each in measures]
    np.testing.assert_array_equal(alone, together)
