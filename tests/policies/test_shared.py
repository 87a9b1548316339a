"""A shared embedding does once what is asked of it twice, and forgets at the right moments."""

from collections import Counter
from copy import copy

import numpy as np
import pytest

from sheath_manip.policies.looking import look
from sheath_manip.policies.pixels import Pixels
from sheath_manip.policies.shared import SharedEmbedding
from sheath_manip.signals import SIGNALS, SignalChoice, make_signal
from sheath_manip.types.seen import Seen
from tests.blobs import fitted_policy, held_out, training
from tests.looks import fitted_signal, measures_of, scores_of


class Counted:
    """The pixels, counting what is asked of them."""

    uses_displaced = False

    def __init__(self) -> None:
        self.pixels = Pixels()
        self.calls = Counter()

    def attach(self, policy):
        return self.pixels.attach(policy)

    def fit(self, seen):
        self.calls["fit"] += 1
        self.pixels.fit(seen)
        return self

    def transform(self, seen):
        self.calls["transform"] += 1
        return self.pixels.transform(seen)

    def arrays(self):
        return self.pixels.arrays()

    def load(self, arrays):
        self.pixels.load(arrays)
        return self


def both(embedding: SharedEmbedding) -> tuple[Seen, Seen]:
    """Training states and new ones, as a policy sees them."""
    policy = fitted_policy("hog-svm")
    readers = embedding.attach(policy)
    return look(policy, training(), readers), look(policy, held_out(), readers)


def test_the_same_states_are_fitted_to_and_transformed_once():
    counted = Counted()
    shared = SharedEmbedding(counted)
    states, others = both(shared)
    first = shared.fit(states).transform(states)
    np.testing.assert_array_equal(shared.fit(states).transform(states), first)
    assert counted.calls == {"fit": 1, "transform": 1}
    np.testing.assert_array_equal(shared.transform(others), counted.transform(others))


def test_it_forgets_with_other_states_another_learned_state_and_another_policy():
    counted = Counted()
    shared = SharedEmbedding(counted)
    states, others = both(shared)
    before = shared.fit(states).transform(others)
    learned = shared.arrays()
    assert (shared.fit(others).transform(others) != before).any()
    np.testing.assert_array_equal(shared.load(learned).transform(others), before)
    shared.fit(others)
    shared.attach(copy(fitted_policy("hog-svm")))
    shared.fit(others)
    assert counted.calls["fit"] == 4


@pytest.mark.parametrize("name", ["joined", "near-joined"])
def test_a_signal_shares_what_it_names_twice_and_scores_the_same(name):
    made = []

    def make(_: str) -> Counted:
        made.append(Counted())
        return made[-1]

    choice = SignalChoice(name, "pixels", "one-class-svm", "pixels")
    apart = SIGNALS[name](choice, make)
    of_its_own = len(made)
    together = make_signal(choice, make)
    assert len(made) - of_its_own == 1
    policy = fitted_policy("hog-svm")
    scores = []
    for signal in (apart, together):
        fitted_signal(signal, policy, training())
        signal.calibrate([measures_of(signal, policy, held_out())])
        scores.append(scores_of(signal, policy, held_out()))
    np.testing.assert_array_equal(*scores)
    assert made[-1].calls["fit"] == 1
