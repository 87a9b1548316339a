"""A network that somebody else has trained, as an embedding of the cameras."""

import sys

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError, SetupError
from sheath_manip.policies.frozen_encoder import Encoded, FrozenEncoder, encoder
from sheath_manip.types import Observations, Proposal
from tests.blobs import held_out, hidden_layer
from tests.small_encoder import CHANNELS, small_encoder

__all__ = ["small_encoder"]
NOTHING = Proposal(np.zeros((2, 1), np.float32))


def test_each_camera_is_looked_at_in_the_order_of_their_names(capsys) -> None:
    top = held_out().images["top"][:2]
    dark = np.zeros((2, 40, 60, 3), np.uint8)
    features = np.zeros((2, 0), np.float32)
    both = Encoded(64)(Observations({"top": top, "side": dark}, features), NOTHING)
    assert both.shape == (2, 2 * CHANNELS)
    np.testing.assert_array_equal(both[0, :CHANNELS], both[1, :CHANNELS])
    alone = Encoded(64)(Observations({"top": top}, features), NOTHING)
    np.testing.assert_array_equal(both[:, CHANNELS:], alone)
    assert np.abs(alone[0] - alone[1]).max() > 0
    # The package tells that it has loaded, which nobody asked for.
    assert capsys.readouterr().out == ""


def test_what_cannot_be_is_said(monkeypatch) -> None:
    with pytest.raises(ParameterError, match="side is 8 px; wanted at least 32"):
        FrozenEncoder(side=8)
    with pytest.raises(ParameterError, match="no camera"):
        Encoded(64)(Observations({}, np.zeros((2, 1), np.float32)), NOTHING)
    encoder.cache_clear()
    monkeypatch.setitem(sys.modules, "efficientnet_lite_pytorch", None)
    with pytest.raises(SetupError, match=r"pip install 'sheath-manip\[encoder\]'"):
        FrozenEncoder().attach(hidden_layer())
    encoder.cache_clear()
