import numpy as np
import pytest

from sheath_manip.signals.joined import JoinedSignal
from sheath_manip.types import Reason
from tests.feature_signal import FeatureSignal


@pytest.mark.parametrize(
    ("measures", "reason"), [([-6.0, -2.0], Reason.OUTSIDE), ([0.0, -6.0], Reason.RISK)]
)
def test_to_blame_is_the_signal_that_finds_a_state_rarest_however_often_it_counts(measures, reason):
    signal = JoinedSignal(
        {"support": FeatureSignal(0, Reason.OUTSIDE), "trust": FeatureSignal(1)},
        {"support": 1.0, "trust": 4.0},
    )
    signal.calibrate([np.random.default_rng(0).normal(size=(2000, 2))])
    assert signal.blames(np.array(measures)) is reason
