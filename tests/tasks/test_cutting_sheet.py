"""The sheet that is cut: as one that was compiled so, put back, cut again, found when deformed."""

from dataclasses import replace
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from sheath_manip.exceptions import ParameterError
from sheath_manip.tasks.gauze_cutting.cutting.crack import Crack
from sheath_manip.tasks.gauze_cutting.cutting.elasticity import Membrane
from sheath_manip.tasks.gauze_cutting.cutting.hex_mesh import Mesh, hex_square
from sheath_manip.tasks.gauze_cutting.cutting.journal import Cut, make_again
from sheath_manip.tasks.gauze_cutting.cutting.locating import lie_of, vertex_positions
from sheath_manip.tasks.gauze_cutting.cutting.pieces import area_in_circle_m2
from sheath_manip.tasks.gauze_cutting.cutting.severing import edge_between, sever
from sheath_manip.tasks.gauze_cutting.cutting.sheet import NONE, Sheet
from tests.tasks.small_sheet import (
    MEMBRANE,
    MESH,
    SIDE_M,
    SPARES,
    circle,
    follow,
    sheet_in,
    simulation,
)


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
