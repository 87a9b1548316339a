from collections import Counter
from itertools import product

import numpy as np
import pytest

from sheath_manip.seeding import generator, scene_seed, seed_for
from sheath_manip.types import Purpose

KEYS = list(product(range(3), range(10), range(30)))
"""training seed, round, index"""


def seeds_of(purpose: Purpose) -> set[int]:
    return {scene_seed(purpose, *key) for key in KEYS}


def test_purposes_never_share_a_scene():
    by_purpose = {purpose: seeds_of(purpose) for purpose in Purpose}
    counted = Counter(seed for seeds in by_purpose.values() for seed in seeds)
    assert max(counted.values()) == 1
    for index, seeds in enumerate(by_purpose.values()):
        assert {seed >> 30 for seed in seeds} == {index}


@pytest.mark.parametrize("purpose", Purpose)
def test_scenes_differ_within_a_purpose_and_fit_a_random_state(purpose):
    seeds = seeds_of(purpose)
    assert len(seeds) == len(KEYS)
    np.random.RandomState(max(seeds))  # which dm_control seeds
    assert min(seeds) >= 0


def test_tuning_scenes_are_not_the_held_out_ones():
    held_out, tuning = (
        {scene_seed(Purpose.EVALUATION, name, index) for index in range(500)}
        for name in ("held-out", "tuning")
    )
    assert not held_out & tuning


def test_depends_on_nothing_but_the_keys():
    # Pinned: a published run can be repeated only while these stay.
    assert seed_for("policy", 0) == 140843776
    assert scene_seed(Purpose.EVALUATION, "held-out", 0) == 4243255701
    np.testing.assert_array_equal(
        generator("gate", "sheath", 0, 1).random(5), generator("gate", "sheath", 0, 1).random(5)
    )
    assert generator("gate", 1).random() != generator("gate", 2).random()
