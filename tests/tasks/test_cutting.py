"""The cutting component on a small sheet of its own."""

from contextlib import suppress
from dataclasses import replace
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np
import pytest
from dm_control import mjcf

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.gauze_cutting.cutting.crack import Crack
from sheath_manip.tasks.gauze_cutting.cutting.elasticity import Membrane
from sheath_manip.tasks.gauze_cutting.cutting.flexcomp import add_sheet
from sheath_manip.tasks.gauze_cutting.cutting.hex_mesh import Mesh, hex_square
from sheath_manip.tasks.gauze_cutting.cutting.journal import Cut, make, make_again
from sheath_manip.tasks.gauze_cutting.cutting.locating import lie_of, vertex_positions
from sheath_manip.tasks.gauze_cutting.cutting.pieces import area_in_circle_m2, area_m2, free_pieces
from sheath_manip.tasks.gauze_cutting.cutting.severing import edge_between, sever
from sheath_manip.tasks.gauze_cutting.cutting.sheet import NONE, Sheet, SparesExhausted
from sheath_manip.tasks.gauze_cutting.cutting.snapping import quality

SIDE_M = 0.06
MESH = hex_square(SIDE_M, 13)
MEMBRANE = Membrane(2e5, 0.2, 5e-4)
VERTEX_KG = 3e-6
SPARES = 20
PINNED = np.flatnonzero((np.abs(MESH.points_m) > SIDE_M / 2 - 0.006).all(axis=1))


def simulation(mesh: Mesh = MESH, spares: int = SPARES) -> mjcf.Physics:
    root: Any = mjcf.RootElement()
    root.option.integrator, root.option.solver = "discrete", "CG"
    root.option.timestep, root.option.iterations = 0.01, 2000
    root.option.tolerance = 1e-10
    root.option.flag.contact = "disable"
    add_sheet(root.worldbody, "gauze", mesh, MEMBRANE, spares, PINNED, VERTEX_KG, 0.002)
    return mjcf.Physics.from_mjcf_model(root)


def sheet_in(physics: mjcf.Physics, spares: int = SPARES) -> Sheet:
    return Sheet(physics.model.ptr, "gauze", MESH, spares, MEMBRANE)


def circle(radius_m: float, points: int = 200) -> np.ndarray:
    """Once around and a little farther, as a blade must go before the front comes to the start."""
    angles = np.linspace(0, 2 * np.pi + 0.6, points) + 0.3
    return radius_m * np.column_stack([np.cos(angles), np.sin(angles)])


def follow(crack: Crack, path: np.ndarray, data: mujoco.MjData | None = None) -> None:
    """Cut along (n, 2) material points; the model alone where there is no data."""
    sheet = crack.sheet

    def cut(each: Cut) -> None:
        if data is None:
            make_again(sheet, each)
        else:
            make(sheet, each, data, lie_of(sheet, data))
        crack.made(each)

    cut(crack.puncture(path[0]))
    for point in path[1:]:
        crack.trail.reach(point)
        while (each := crack.next_cut()) is not None:
            cut(each)


def slit_along_a_row(sheet: Sheet) -> None:
    row = np.flatnonzero(np.abs(MESH.points_m[:, 1]) < 1e-9)[3:9]
    for start, end in pairwise(row):
        # A vertex that was doubled goes on under either name.
        edges = (edge_between(sheet, int(copy), int(end)) for copy in sheet.copies(int(start)))
        edge = next(edge for edge in edges if edge is not None)
        sever(sheet, edge)


def slit_along_an_arc(sheet: Sheet) -> None:
    follow(Crack(sheet), circle(0.013)[:120])


@pytest.mark.parametrize("slit", [slit_along_a_row, slit_along_an_arc])
def test_a_slit_at_run_time_is_as_one_that_was_compiled(slit):
    physics = simulation()
    sheet = sheet_in(physics)
    slit(sheet)
    used = sheet.spares.start
    assert used > len(MESH.points_m) + 3
    compiled = Mesh(sheet.rest_m[:used].copy(), sheet.active_elements.copy(), MESH.size_m)
    reference = simulation(compiled, spares=0)

    rng = np.random.default_rng(0)
    moved = rng.normal(0, 2e-4, (used, 3))
    ends = []
    for each in (physics, reference):
        model, data = each.model.ptr, each.data.ptr
        bodies = model.flex_vertbodyid[:used]
        free = np.flatnonzero(model.body_dofnum[bodies] == 3)
        joints = model.jnt_qposadr[model.body_jntadr[bodies[free]]]
        rest = np.column_stack([compiled.points_m, np.zeros(used)])
        places = (rest + moved)[free]
        data.qpos[joints[:, None] + np.arange(3)] = places - model.body_pos[bodies[free]]
        mujoco.mj_step(model, data, 300)
        assert not any(warning.number for warning in data.warning)
        mujoco.mj_kinematics(model, data)
        ends.append(data.xpos[bodies[free]])
    # It has sagged by much more than what the two may differ by.
    assert ends[0][:, 2].min() < -1e-3
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-7)


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


def assert_a_mesh(sheet: Sheet) -> None:
    """Elements, edges and flaps agree, and no element is a sliver."""
    elements, count = sheet.active_elements, len(sheet.active_elements)
    assert quality(sheet.rest_m[elements]).min() > 0.1
    own = sheet.element_edges[:count]
    for corner in range(3):
        ends = np.sort(np.delete(elements, corner, axis=1), axis=1)
        np.testing.assert_array_equal(np.sort(sheet.edges[own[:, corner]], axis=1), ends)
        assert (sheet.flaps[own[:, corner]] == elements[:, [corner]]).any(axis=1).all()
    owners = np.bincount(own.ravel(), minlength=len(sheet.edges))
    used = sheet.active_edges
    np.testing.assert_array_equal(owners[used], 2 - (sheet.flaps[used, 1] == NONE))


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


def test_the_area_in_a_circle_is_exact():
    sheet = sheet_in(simulation())
    everything = np.arange(len(MESH.triangles))
    inside = area_in_circle_m2(sheet, everything, np.array([0.004, -0.003]), 0.02)
    assert inside == pytest.approx(np.pi * 0.02**2, rel=1e-12)
    # A circle around a corner of the square has a quarter in it.
    quarter = area_in_circle_m2(sheet, everything, np.full(2, SIDE_M / 2), 0.02)
    assert quarter == pytest.approx(np.pi * 0.02**2 / 4, rel=1e-12)
    assert area_in_circle_m2(sheet, everything, np.zeros(2), 1.0) == pytest.approx(SIDE_M**2)


def test_restoring_brings_back_the_model_to_the_bit():
    physics = simulation()
    model, data = physics.model.ptr, physics.data.ptr
    sheet = sheet_in(physics)

    def arrays() -> dict[str, np.ndarray]:
        names = [name for name in dir(model) if name.startswith(("flex", "body_", "dof_", "jnt_"))]
        return {name: np.array(getattr(model, name)) for name in names}

    before = arrays()
    mujoco.mj_forward(model, data)
    follow(Crack(sheet), circle(0.013), data)
    assert not np.array_equal(arrays()["flex_elem"], before["flex_elem"])
    sheet.restore()
    for name, array in arrays().items():
        np.testing.assert_array_equal(array, before[name], err_msg=name)
    np.testing.assert_array_equal(sheet.rest_m[: len(MESH.points_m)], MESH.points_m)
    assert (sheet.spare_vertices, sheet.spare_edges) == (3 * SPARES, 3 * SPARES)


def test_another_stiffness_is_as_if_it_was_compiled():
    sheet = sheet_in(simulation())
    compiled = sheet.stiffness.copy(), sheet.bending.copy()
    sheet.membrane = replace(MEMBRANE, young_pa=3e5)
    sheet.restore()
    soft_made_stiff = sheet.stiffness.copy(), sheet.bending.copy()
    sheet.recompute(range(len(MESH.triangles)))
    np.testing.assert_allclose(sheet.stiffness, soft_made_stiff[0], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(sheet.bending, soft_made_stiff[1], rtol=1e-9, atol=1e-18)
    sheet.restore()
    np.testing.assert_array_equal(sheet.stiffness, soft_made_stiff[0])
    sheet.membrane = MEMBRANE
    sheet.restore()
    np.testing.assert_array_equal(sheet.stiffness, compiled[0])
    np.testing.assert_array_equal(sheet.bending, compiled[1])


def test_the_journal_makes_the_same_cut_again():
    physics = simulation()
    sheet = sheet_in(physics)
    mujoco.mj_forward(physics.model.ptr, physics.data.ptr)
    crack = Crack(sheet)
    follow(crack, circle(0.013), physics.data.ptr)
    elements, bending = sheet.elements.copy(), sheet.bending.copy()
    rows = [cut.row() for cut in crack.cuts]
    sheet.restore()
    for row in rows:
        make_again(sheet, Cut.of(row))
    np.testing.assert_array_equal(sheet.elements, elements)
    np.testing.assert_array_equal(sheet.bending, bending)


def test_without_spares_nothing_is_cut():
    sheet = sheet_in(simulation(spares=4), spares=4)
    with pytest.raises(SparesExhausted):
        follow(Crack(sheet), circle(0.013))
    assert sheet.spare_vertices in (0, 1)
    assert quality(sheet.rest_m[sheet.active_elements]).min() > 0.1


def test_a_doubled_vertex_moves_like_the_one_that_it_comes_from():
    physics = simulation()
    model, data = physics.model.ptr, physics.data.ptr
    sheet = sheet_in(physics)
    mujoco.mj_step(model, data, 30)
    mujoco.mj_kinematics(model, data)
    before = lie_of(sheet, data).of(np.array([0.0, 0.0131]))
    follow(Crack(sheet), circle(0.013)[:90], data)
    mujoco.mj_kinematics(model, data)
    positions = vertex_positions(sheet, data)
    for vertex in range(len(MESH.points_m), sheet.spares.start):
        source = next(each for each in sheet.copies(vertex) if each < len(MESH.points_m))
        np.testing.assert_allclose(positions[vertex], positions[source], atol=1e-12)
        own, copied = sheet.dofs[[source, vertex]]
        np.testing.assert_array_equal(data.qvel[own : own + 3], data.qvel[copied : copied + 3])
    after = lie_of(sheet, data).of(np.array([0.0, 0.0131]))
    np.testing.assert_allclose(after.world_m, before.world_m, atol=5e-5)


def test_places_are_found_in_the_deformed_sheet():
    physics = simulation()
    model, data = physics.model.ptr, physics.data.ptr
    sheet = sheet_in(physics)
    mujoco.mj_step(model, data, 30)
    mujoco.mj_kinematics(model, data)
    lie = lie_of(sheet, data)
    points = np.random.default_rng(0).uniform(-0.02, 0.02, (20, 2))
    each = [lie.of(point).world_m for point in points]
    np.testing.assert_allclose(lie.positions_of(points), each, atol=1e-12)
    for point in points:
        there = lie.of(point)
        assert there.inside
        back = lie.below(there.world_m[:2], point, 0.02)
        np.testing.assert_allclose(back.material_m, point, atol=1e-12)


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


def test_errors_say_what_was_wanted():
    physics = simulation()
    sheet = sheet_in(physics)
    rim = int(np.flatnonzero(sheet.flaps[:, 1] == NONE)[0])
    with pytest.raises(ParameterError, match="inner, free"):
        sever(sheet, rim)
    with pytest.raises(ParameterError, match="wanted"):
        Sheet(physics.model.ptr, "gauze", MESH, SPARES + 1, MEMBRANE)
    with pytest.raises(ParameterError, match="no flex"):
        Sheet(physics.model.ptr, "nonesuch", MESH, SPARES, MEMBRANE)
    with pytest.raises(ParameterError, match="3 or more"):
        hex_square(0.1, 2)
    with pytest.raises(ParameterError, match="poisson"):
        Membrane(1e5, 0.5, 1e-3)
