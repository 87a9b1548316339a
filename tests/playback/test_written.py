"""Numbers in titles have no more digits than say something, and are no powers of ten."""

import pytest

from sheath_manip.playback.written import in_percent, rounded


@pytest.mark.parametrize(
    ("number", "written"),
    [(0.314, "0.31"), (1.62, "1.6"), (40.4, "40"), (131.6, "130"), (1234.0, "1,200"), (0, "0")],
)
def test_a_number_has_two_digits_that_say_something(number, written):
    assert rounded(number) == written


def test_a_share_is_in_percent_and_never_rounded_up_to_all_too_soon():
    shares = (0.0047, 0.137, 0.994, 0.996)
    assert [in_percent(each) for each in shares] == ["0.47 %", "14 %", "99 %", "100 %"]
