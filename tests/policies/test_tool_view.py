"""What is seen from the tool."""

from dataclasses import replace

import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies import make_embedding
from sheath_manip.policies.tool_view import ToolView
from sheath_manip.signals.near_precedent import NearPrecedentSignal
from tests import line
from tests.looks import fitted_signal, scores_of

VIEW = ToolView(line.SPEC, side_px=41, px_m=line.PX_M)
BLUE = 180


def blue_px(image: np.ndarray) -> np.ndarray:
    """(n, 2) columns and rows of the line's pixels, from the tool."""
    rows, columns = np.nonzero(image[..., 2] > BLUE)
    return np.column_stack([columns, rows]) - 20


@pytest.mark.parametrize("heading_rad", [0.0, 0.7, 2.0, -1.3])
@pytest.mark.parametrize("tool_m", [(0.0, 0.0), (0.012, -0.008)])
def test_the_line_lies_beside_the_tool_wherever_that_is_and_however_it_heads(tool_m, heading_rad):
    samples = line.samples_at(tool_m, heading_rad, beside_m=0.01)
    seen = VIEW.samples(samples)
    places = blue_px(seen.images["above"][0])
    assert len(places) > 30
    # A centimetre to its left, which is below, are 5 pixels; lines are drawn from whole pixels.
    np.testing.assert_allclose(np.median(places[:, 1]), 5, atol=1.1)
    np.testing.assert_allclose(seen.labels[0], [line.SPEED, 0.01 / 0.03], atol=1e-6)


def test_actions_come_back_from_the_tools_frame():
    samples = line.held_out()
    seen = VIEW.actions(samples.labels, samples.features)
    assert np.abs(seen - samples.labels).max() > 0.5
    back = VIEW.actions_in_world(seen, samples.features)
    np.testing.assert_allclose(back, samples.labels, atol=1e-6)
    bounds = VIEW.spec.action
    assert (np.abs(seen) <= bounds.maximum).all()


def test_only_what_says_where_the_tool_is_is_left_out():
    assert VIEW.spec.feature_names == ("depth_m",)
    samples = line.held_out()
    np.testing.assert_array_equal(VIEW.features(samples.features), samples.features[:, 2:3])


def test_actions_without_a_vector_stay_as_they_are():
    spec = replace(line.SPEC, tool_frame=replace(line.FRAME, vector=()))
    samples = line.held_out()
    view = ToolView(spec)
    np.testing.assert_array_equal(view.actions(samples.labels, samples.features), samples.labels)
    np.testing.assert_array_equal(view.spec.action.maximum, spec.action.maximum)


def test_a_precedent_is_one_wherever_it_was():
    """States and actions compare in the tool's frame alone."""
    policy, states = line.fitted_policy(), line.training()
    signal = fitted_signal(NearPrecedentSignal(make_embedding("tool-points")), policy, states)
    np.testing.assert_allclose(
        scores_of(signal, policy, line.turned(states)),
        scores_of(signal, policy, states),
        atol=0.1,
    )


def test_bad_sizes_are_named():
    with pytest.raises(ParameterError, match="side_px is 0"):
        ToolView(line.SPEC, side_px=0)
    with pytest.raises(ParameterError, match="px_m -1"):
        ToolView(line.SPEC, px_m=-1.0)
