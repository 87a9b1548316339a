import numpy as np
import pytest
from numpy.typing import NDArray

from sheath_manip.dashboard.scene import capsule
from sheath_manip.dashboard.support_picture import Ground, SupportPicture, Track, ground_of
from sheath_manip.exceptions import ParameterError
from sheath_manip.playback import palette
from sheath_manip.protocols import Viewable
from sheath_manip.support.plane import NUS, PlaneLevels, plane_levels
from sheath_manip.types import Actor


def score(levels: PlaneLevels, nu: float, x_m: float, y_m: float) -> float:
    row = int(np.abs(levels.y_m - y_m).argmin())
    column = int(np.abs(levels.x_m - x_m).argmin())
    return float(levels.scores[nu][row, column])


def test_levels_follow_the_road_and_do_not_fill_it_in(training: NDArray) -> None:
    levels = plane_levels(training)
    assert set(levels.scores) == set(NUS)
    for nu in NUS:
        assert levels.scores[nu].shape == (len(levels.y_m), len(levels.x_m))
        assert score(levels, nu, 0, 0) < 0
        # 8 m off the centre line, beyond the road's edge.
        assert score(levels, nu, 36, 0) < 0
        assert score(levels, nu, 20, 0) < 0
    angles = np.linspace(0, 2 * np.pi, 60)
    on_centre = [score(levels, 0.01, 28 * np.cos(a), 18 * np.sin(a)) > 0 for a in angles]
    assert np.mean(on_centre) > 0.95


def test_larger_nu_gives_a_smaller_support(training: NDArray) -> None:
    levels = plane_levels(training, resolution=60)
    areas = [(levels.scores[nu] > 0).sum() for nu in NUS]
    assert areas == sorted(areas, reverse=True)


def test_boundary_closes_within_the_grid(training: NDArray) -> None:
    for grid in plane_levels(training).scores.values():
        edge = np.concatenate([grid[0], grid[-1], grid[:, 0], grid[:, -1]])
        assert (edge < 0).all()


def test_levels_repeat_and_take_many_positions() -> None:
    positions = np.random.default_rng(1).normal(size=(5000, 2))
    first, second = plane_levels(positions, [0.05], 40), plane_levels(positions, [0.05], 40)
    assert np.array_equal(first.scores[0.05], second.scores[0.05])


@pytest.mark.parametrize(
    "positions", [np.zeros((5, 3)), np.zeros((5, 2)), np.zeros((0, 2)), [[0, np.nan], [1, 1]]]
)
def test_levels_refuse_what_has_no_support(positions: NDArray) -> None:
    with pytest.raises(ParameterError, match="wanted"):
        plane_levels(positions)


def test_ground_lies_where_the_scene_puts_it(environment: Viewable) -> None:
    ground = ground_of(environment.scene(), environment.pose())
    assert ground is not None
    picture = SupportPicture(ground, np.zeros((0, 2)), None).draw(Track(np.zeros((0, 2)), ()))
    assert picture.shape == (480, 480, 3)
    # The ground's red square is at +x +y, the blue one at -x +y.
    assert picture[37, 442].argmax() == 0
    assert picture[37, 37].argmax() == 2


def test_present_position_is_marked_by_who_acts() -> None:
    ground = Ground(
        np.full((10, 10, 3), 200, np.uint8), np.array([5.0, 0.0]), np.array([10.0, 5.0])
    )
    still = SupportPicture(ground, np.zeros((0, 2)), None)
    for actor in Actor:
        picture = still.draw(Track(np.array([[10.0, 2.5]]), (actor,)))
        assert picture.shape == (240, 480, 3)
        assert tuple(picture[60, 360]) == palette.ACTOR[actor]
    outside = still.draw(Track(np.array([[99.0, 0.0]]), (Actor.POLICY,)))
    assert tuple(outside[120, 473]) == palette.ACTOR[Actor.POLICY]


def test_support_is_tinted_without_a_ground(training: NDArray) -> None:
    picture = SupportPicture(None, training, plane_levels(training)).draw(
        Track(np.zeros((0, 2)), ())
    )
    middle = picture[picture.shape[0] // 2, picture.shape[1] // 2]
    assert tuple(middle) == palette.INK
    yellow = (picture[..., 0] > 100) & (picture[..., 1] > 100) & (picture[..., 2] < 100)
    assert 0.02 < yellow.mean() < 0.5


def test_capsule_faces_point_outwards() -> None:
    vertices, faces = capsule(1.0, 2.0)
    assert np.allclose([vertices.min(0), vertices.max(0)], [[-1, -1, -3], [1, 1, 3]])
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    flat = np.linalg.norm(normals, axis=1) < 1e-6
    assert (np.einsum("ij,ij->i", normals, a + b + c)[~flat] > 0).all()
