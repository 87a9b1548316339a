import numpy as np
import pytest

from sheath_manip.learning.theory import Bound, measure
from sheath_manip.types import Episode
from tests.episodes import episode_of


def episodes(*lengths: int) -> list[Episode]:
    return [episode_of("p" * length) for length in lengths]


def test_the_quantities_of_one_round():
    scores = np.array([0.5, 0.2, 0.1, -0.3, 0.0, 0.3])
    losses = np.array([0, 0, 1, 1, 1, 0], float)
    bound = measure(episodes(4, 2), scores, 0.1, losses, epsilon=0.04)
    assert bound.horizon == 3
    assert bound.xi == pytest.approx(2 / 6)
    assert bound.measured == pytest.approx(3 * 0.5)
    assert bound.value == pytest.approx(3 * (0.04 + 2 / 6))


def test_the_boundary_is_inside_and_no_score_is_outside():
    scores = np.array([0.1, np.nan, 1.0, np.nan])
    bound = measure(episodes(4), scores, 0.1, np.zeros(4), epsilon=0.0)
    assert bound.xi == 0.5


def test_the_bound_holds_where_all_mistakes_lie_outside_or_within_epsilon():
    rng = np.random.default_rng(0)
    for _ in range(50):
        scores = rng.normal(size=200)
        epsilon = rng.uniform(0, 0.3)
        losses = (scores < 0).astype(float)
        inside = np.flatnonzero(scores >= 0)
        losses[inside[: int(epsilon * 200)]] = 1.0
        bound = measure(episodes(120, 80), scores, 0.0, losses, epsilon)
        assert bound.measured <= bound.value + 1e-9


def test_without_mistakes_and_outsiders_the_bound_is_zero():
    assert Bound(horizon=100, epsilon=0.0, xi=0.0, measured=0.0).value == 0.0
