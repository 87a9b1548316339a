import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sheath_manip.tasks.driving.track import Track
from tests.cases import cases

TRACK = Track()
TRACKS = (TRACK, Track(half_length=30.0, half_width=12.0, corner_radius=6.0, road_half_width=3.0))

tracks = st.sampled_from(TRACKS)
laps = st.floats(0, 1, exclude_max=True)
sides = st.floats(-1, 1)


def apart(s, other, lap):
    """Along the lap, the short way round."""
    return abs((s - other + lap / 2) % lap - lap / 2)


@cases(100)
@given(tracks, laps, sides)
def test_pose_and_coordinates_are_inverse(track, share, side):
    s, lateral = share * track.lap_length, side * track.road_half_width
    x, y, heading = track.pose(np.array(s), np.array(lateral))
    back_s, back_lateral, back_heading = track.coordinates(x, y)
    assert apart(back_s, s, track.lap_length) < 1e-6
    assert back_lateral == pytest.approx(lateral, abs=1e-6)
    assert np.cos(back_heading - heading) == pytest.approx(1)


@cases(100)
@given(tracks, laps, sides, st.floats(-0.5, 0.5))
def test_a_step_along_the_road_is_a_step_of_s(track, share, side, step_m):
    s, lateral = share * track.lap_length, side * track.road_half_width
    here, there = track.pose(np.array([s, s + step_m]), np.array(lateral))
    walked = np.hypot(*(there - here)[:2])
    # In a corner the outer lane is longer, the inner one shorter.
    stretch = 1 + track.road_half_width / track.corner_radius
    assert walked <= abs(step_m) * stretch + 1e-9
    assert walked >= abs(step_m) * (2 - stretch) * 0.9 - 1e-9


@cases(100)
@given(tracks, laps)
def test_left_is_towards_the_inside(track, share):
    s = np.array(share * track.lap_length)
    _, _, heading = middle = track.pose(s, np.array(0.0))
    inner = track.pose(s, np.array(1.0))
    left = np.array([-np.sin(heading), np.cos(heading)])
    np.testing.assert_allclose((inner - middle)[:2], left, atol=1e-9)
    assert np.hypot(*inner[:2]) < np.hypot(*middle[:2])


def test_the_lap_closes_and_runs_counter_clockwise():
    s = np.linspace(0, TRACK.lap_length, 2000)
    x, y, heading = np.moveaxis(TRACK.pose(s, np.zeros_like(s)), -1, 0)
    assert (x[0], y[0]) == pytest.approx((x[-1], y[-1]))
    assert (x[0], y[0], heading[0]) == (0.0, -TRACK.half_width, 0.0)
    assert np.hypot(np.diff(x), np.diff(y)).sum() == pytest.approx(TRACK.lap_length, rel=1e-4)
    area = 0.5 * (x[:-1] * y[1:] - x[1:] * y[:-1]).sum()
    assert area > 0
    assert np.unwrap(heading)[-1] == pytest.approx(2 * np.pi)


def test_works_on_any_shape():
    s, lateral = np.meshgrid(np.linspace(0, 300, 7), np.linspace(-4, 4, 5))
    poses = TRACK.pose(s, lateral)
    assert poses.shape == (5, 7, 3)
    back = TRACK.coordinates(poses[..., 0], poses[..., 1])
    assert [array.shape for array in back] == [(5, 7)] * 3
    np.testing.assert_allclose(back[1], lateral, atol=1e-9)


def test_the_picture_shows_road_where_the_road_is():
    scale = 4.0
    picture = TRACK.picture(scale)
    extent_x, extent_y = TRACK.extent
    assert picture.shape == (round(2 * extent_y * scale), round(2 * extent_x * scale), 3)
    assert picture.dtype == np.uint8

    def colour(lateral):
        s = np.linspace(5, TRACK.lap_length - 5, 200)
        x, y, _ = np.moveaxis(TRACK.pose(s, np.full_like(s, lateral)), -1, 0)
        rows, columns = ((extent_y - y) * scale).astype(int), ((x + extent_x) * scale).astype(int)
        return np.median(picture[rows, columns].astype(float), axis=0)

    for lateral in (-2.0, 2.0):
        red, green, blue = colour(lateral)
        assert abs(green - blue) < 15 > abs(green - red)
    for lateral in (-6.5, 6.5):
        red, green, blue = colour(lateral)
        assert green > blue + 40
