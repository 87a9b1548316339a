"""Wherever the blade goes, the sheet stays a mesh and is cut where it went."""

from contextlib import suppress

import numpy as np
import pytest

from sheath_manip.tasks.gauze_cutting.cutting.crack import Crack
from sheath_manip.tasks.gauze_cutting.cutting.pieces import area_in_circle_m2, area_m2, free_pieces
from sheath_manip.tasks.gauze_cutting.cutting.sheet import SparesExhausted
from sheath_manip.tasks.gauze_cutting.cutting.snapping import quality
from tests.tasks.small_sheet import MESH, assert_a_mesh, circle, follow, sheet_in, simulation


def test_the_mesh_stays_a_mesh_while_a_ring_is_cut():
    sheet = sheet_in(simulation())
    area = area_m2(sheet, np.arange(len(MESH.triangles)))
    crack = Crack(sheet)
    follow(crack, circle(0.013, 260))
    assert_a_mesh(sheet)
    everything = np.arange(len(MESH.triangles))
    assert area_m2(sheet, everything) == pytest.approx(area, rel=1e-12)
    pieces = free_pieces(sheet)
    assert len(pieces) == 1
    disc = area_m2(sheet, pieces[0])
    shared = area_in_circle_m2(sheet, pieces[0], np.zeros(2), 0.013)
    wanted = np.pi * 0.013**2
    # Chords of a mesh size: their circle is not quite the circle.
    assert shared / (disc + wanted - shared) > 0.97


def wandering(seed: int) -> np.ndarray:
    """(n, 2) a blade that turns at random, crosses its own cut and comes near the rim."""
    rng = np.random.default_rng(seed)
    point, heading, turn, path = rng.uniform(-0.01, 0.01, 2), rng.uniform(-np.pi, np.pi), 0.0, []
    for _ in range(300):
        turn = 0.9 * turn + rng.normal(0, 0.06)
        heading += turn
        way = np.array([np.cos(heading), np.sin(heading)])
        point = point + rng.uniform(2e-4, 1.3e-3) * way
        if np.abs(point).max() > 0.022:
            heading += np.pi / 2
            point = np.clip(point, -0.022, 0.022)
        path.append(point)
    return np.array(path)


def test_wherever_the_blade_goes_the_mesh_stays_a_mesh():
    sheet = sheet_in(simulation())
    everything = np.arange(len(MESH.triangles))
    area = area_m2(sheet, everything)
    for seed in range(6):
        sheet.restore()
        crack = Crack(sheet)
        with suppress(SparesExhausted):
            follow(crack, wandering(seed))
        assert len(crack.cuts) > 20
        assert_a_mesh(sheet)
        assert area_m2(sheet, everything) == pytest.approx(area, rel=1e-12)


def test_without_spares_nothing_is_cut():
    sheet = sheet_in(simulation(spares=4), spares=4)
    with pytest.raises(SparesExhausted):
        follow(Crack(sheet), circle(0.013))
    assert sheet.spare_vertices in (0, 1)
    assert quality(sheet.rest_m[sheet.active_elements]).min() > 0.1


def test_a_blade_that_goes_back_and_forth_cuts_no_more():
    sheet = sheet_in(simulation())
    crack = Crack(sheet)
    forth = np.column_stack([np.linspace(0, 0.012, 60), np.full(60, 0.0003)])
    follow(crack, forth)
    made = len(crack.cuts)
    for point in [*forth[::-1], *forth]:
        crack.trail.reach(point)
        assert crack.next_cut() is None
    assert len(crack.cuts) == made


def test_a_blade_that_leaves_its_slit_sideways_cuts_on_from_there():
    sheet = sheet_in(simulation())
    crack = Crack(sheet)
    forth = np.column_stack([np.linspace(-0.012, 0.012, 80), np.zeros(80)])
    aside = np.column_stack([np.zeros(60), np.linspace(0, 0.014, 60)])
    follow(crack, np.concatenate([forth, forth[:39:-1], aside]))
    reached = np.array([sheet.rest_m[cut.end] for cut in crack.cuts])
    assert reached[:, 1].max() > 0.007
    assert reached[:, 0].max() > 0.007
    assert not free_pieces(sheet)
