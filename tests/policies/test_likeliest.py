"""A network that says nothing finite chooses nothing."""

import numpy as np
import pytest

from sheath_manip.policies.choices import likeliest
from tests.toy import CHOICES


def test_the_highest_score_is_chosen_and_others_may_be_out_of_the_question():
    scores = np.array([[0.1, 0.7, 0.2], [-np.inf, -1.0, -np.inf]])
    np.testing.assert_array_equal(likeliest(CHOICES, scores), CHOICES[[1, 1]])


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_score_that_is_no_number_makes_no_action(bad, place):
    scores = np.array([[0.1, 0.7, 0.2], [0.1, 0.2, 0.7]])
    scores[0, place] = bad
    chosen = likeliest(CHOICES, scores)
    assert np.isnan(chosen[0]).all()
    np.testing.assert_array_equal(chosen[1], CHOICES[2])


def test_where_all_is_out_of_the_question_nothing_is_chosen():
    assert np.isnan(likeliest(CHOICES, np.full((1, 3), -np.inf))).all()
