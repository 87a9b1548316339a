from itertools import pairwise

import pytest

from sheath_manip.learning.headway import (
    LEAST_S,
    LEAST_SHARE,
    HeadwayCount,
    left_words,
    time_left_s,
)
from sheath_manip.types.work import Headway


@pytest.mark.parametrize("share", [LEAST_SHARE, 0.25, 0.5, 1.0])
@pytest.mark.parametrize("took_s", [LEAST_S, 60.0, 1e6])
def test_the_rest_takes_as_long_as_the_same_share_took(took_s, share):
    left_s = time_left_s(took_s, share)
    assert left_s is not None
    assert took_s / share == pytest.approx(took_s + left_s)


def test_nothing_is_told_from_too_little():
    assert time_left_s(LEAST_S - 0.1, 0.5) is None
    assert time_left_s(60.0, LEAST_SHARE / 2) is None


def test_at_an_even_pace_every_word_of_the_time_left_is_true():
    clock = iter(range(3, 1000, 3))
    counted = HeadwayCount(100, lambda: float(next(clock)))
    told = [counted.count() for _ in range(100)]
    assert [each.done for each in told] == list(range(1, 101))
    known = [each.left_s for each in told if each.left_s is not None]
    assert len(known) > 90
    assert [before - after for before, after in pairwise(known)] == pytest.approx([3.0] * 97)
    assert known[-1] == 0.0


def test_it_never_counts_beyond_the_end():
    counted = HeadwayCount(2, lambda: 10.0)
    assert [counted.count().done for _ in range(3)] == [1, 2, 2]
    assert HeadwayCount(0, lambda: 10.0).count() == Headway(0, 0)


@pytest.mark.parametrize(
    ("left_s", "words"),
    [
        (None, ""),
        (3.0, "about 10 s left"),
        (44.0, "about 40 s left"),
        (61.0, "about 1 min left"),
        (44 * 60.0, "about 44 min left"),
        (3599.0, "about 1 h 00 min left"),
        (7500.0, "about 2 h 05 min left"),
    ],
)
def test_the_words_have_no_more_digits_than_are_known(left_s, words):
    assert left_words(Headway(1, 2, left_s)) == words
    assert left_words(Headway(2, 2, left_s)) == ""
