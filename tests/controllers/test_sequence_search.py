from itertools import product

import numpy as np
import pytest

from sheath_manip.controllers.sequence_search import SequenceSearch
from sheath_manip.exceptions import ParameterError

CHOICES = np.array([[-1.0], [0.0], [1.0]])


def test_tries_every_sequence_of_segments_once():
    search = SequenceSearch(CHOICES, (1, 2, 3))
    assert search.sequences.shape == (27, 6, 1)
    held = search.sequences[:, [0, 1, 3], 0]
    assert {tuple(row) for row in held} == set(product((-1.0, 0.0, 1.0), repeat=3))
    for first, last in ((1, 2), (3, 4), (4, 5)):
        np.testing.assert_array_equal(search.sequences[:, first], search.sequences[:, last])
    np.testing.assert_array_equal(CHOICES[search.first], search.sequences[:, 0])


def test_the_papers_search_has_243_sequences():
    assert len(SequenceSearch(CHOICES, (1, 1, 2, 3, 5)).sequences) == 243


def test_finds_the_first_action_of_the_cheapest_sequence():
    target = np.array([1.0, -1.0, -1.0])
    search = SequenceSearch(CHOICES, (1, 2))

    def cost(sequences):
        return np.abs(sequences[:, :, 0] - target).sum(axis=1)

    np.testing.assert_array_equal(search.costs_of_first_actions(cost), [2.0, 1.0, 0.0])
    best = search.best_first_action(cost)
    assert best.dtype == np.float32
    np.testing.assert_array_equal(best, [1.0])


def test_looks_past_a_first_action_that_is_dear_now():
    search = SequenceSearch(CHOICES, (1, 1))

    def cost(sequences):
        first, second = sequences[:, 0, 0], sequences[:, 1, 0]
        # Going left costs 1 at once and only after it going left again pays 5.
        return (first == -1) * 1.0 - ((first == -1) & (second == -1)) * 5.0

    np.testing.assert_array_equal(search.best_first_action(cost), [-1.0])


@pytest.mark.parametrize("seed", range(5))
def test_agrees_with_brute_force_for_actions_of_two_dimensions(seed):
    rng = np.random.default_rng(seed)
    choices = rng.normal(size=(4, 2))
    search = SequenceSearch(choices, (1, 2))
    weights = rng.normal(size=(3, 2))

    def cost(sequences):
        return (sequences * weights).sum(axis=(1, 2))

    pairs = [
        (cost(np.stack([choices[i], choices[j], choices[j]])[None])[0], i)
        for i, j in product(range(4), repeat=2)
    ]
    np.testing.assert_allclose(search.best_first_action(cost), choices[min(pairs)[1]], rtol=1e-6)


def test_ties_go_to_the_first_choice():
    search = SequenceSearch(CHOICES, (2,))
    np.testing.assert_array_equal(search.best_first_action(lambda s: np.zeros(len(s))), [-1.0])


@pytest.mark.parametrize("segments", [(), (1, 0), (-1,)])
def test_segments_that_are_none_are_refused(segments):
    with pytest.raises(ParameterError, match="wanted at least one of 1 or more"):
        SequenceSearch(CHOICES, segments)
