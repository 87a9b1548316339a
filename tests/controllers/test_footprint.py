"""Room around a rectangle, by the way that it is turned."""

import numpy as np
import pytest

from sheath_manip.controllers.footprint import clearances


def test_room_depends_on_the_way_it_is_turned():
    points = np.array([[0.10, 0.0], [0.0, -0.20]])
    rooms = clearances(points, np.array([0.0, np.pi / 2]), half_along_m=0.06, half_across_m=0.02)
    np.testing.assert_allclose(rooms, [0.04, 0.08])


def test_a_corner_is_as_near_as_it_looks_and_inside_is_no_room():
    assert clearances(np.array([[0.09, 0.06]]), np.zeros(1), 0.06, 0.02)[0] == pytest.approx(0.05)
    assert clearances(np.array([[0.01, 0.01]]), np.zeros(1), 0.06, 0.02)[0] == 0


def test_nothing_around_leaves_all_room():
    assert clearances(np.zeros((0, 2)), np.zeros(2), 0.06, 0.02).tolist() == [np.inf, np.inf]
