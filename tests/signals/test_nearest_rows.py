"""Nearest vectors, and nearest states by their labels, against all distances written out."""

import numpy as np
import pytest

from sheath_manip.policies.features import Features
from sheath_manip.signals import labelled_states
from sheath_manip.signals.labelled_states import LabelledStates
from sheath_manip.signals.nearest_rows import NearestRows
from sheath_manip.types.seen import Seen


def vectors(seed: int, count: int) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, 5)).astype(np.float32)


def apart(new: np.ndarray, fixed: np.ndarray) -> np.ndarray:
    return np.linalg.norm(new[:, None].astype(float) - fixed[None], axis=2)


@pytest.mark.parametrize("count", [1, 3])
def test_the_nearest_are_those_of_all_distances(count):
    fixed, new = vectors(0, 50), vectors(1, 7)
    found = np.sqrt(NearestRows(fixed).nearest(new, count))
    expected = np.sort(apart(new, fixed), axis=1)[:, :count]
    np.testing.assert_allclose(np.sort(found, axis=1), expected, rtol=1e-4)
    np.testing.assert_allclose(found[:, -1], expected[:, -1], rtol=1e-4)


def test_where_there_are_too_few_the_last_is_infinitely_far():
    found = NearestRows(vectors(0, 2)).nearest(vectors(1, 4), 3)
    assert (found[:, -1] == np.inf).all()
    assert np.isfinite(found).sum(axis=1).tolist() == [2] * 4


@pytest.mark.parametrize("most", [0, 64])
@pytest.mark.parametrize("place", [1, 2])
def test_states_are_near_by_their_labels_however_many_labels_there_are(most, place, monkeypatch):
    monkeypatch.setattr(labelled_states, "MOST_CHOICES", most)
    rng = np.random.default_rng(2)
    fixed, new = vectors(0, 60), vectors(1, 9)
    labels = rng.integers(0, 3, (60, 1)).astype(np.float32)
    proposed = rng.integers(0, 3, (9, 1)).astype(np.float32)
    states = LabelledStates(Features()).fit(labels, Seen(fixed, labels, {}))
    seen = Seen(new, proposed, {})
    same = proposed == labels.T
    alike = np.sort(np.where(same, apart(new, fixed), np.inf), axis=1)[:, place - 1]
    unlike = np.where(same, np.inf, apart(new, fixed)).min(axis=1)
    np.testing.assert_allclose(states.alike(seen, place), alike, rtol=1e-4)
    np.testing.assert_allclose(states.unlike(seen), unlike, rtol=1e-4)
    unsaid = Seen(new[:2], np.array([[np.nan], [5]], np.float32), {})
    np.testing.assert_array_equal(states.alike(unsaid, place), [np.nan, np.inf])
