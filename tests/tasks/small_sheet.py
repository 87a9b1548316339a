"""A small sheet for tests of cutting, what cuts it along a path, and what makes it a mesh."""

from typing import Any

import mujoco
import numpy as np
from dm_control import mjcf

from sheath_manip.tasks.gauze_cutting.cutting.crack import Crack
from sheath_manip.tasks.gauze_cutting.cutting.elasticity import Membrane
from sheath_manip.tasks.gauze_cutting.cutting.flexcomp import add_sheet
from sheath_manip.tasks.gauze_cutting.cutting.hex_mesh import Mesh, hex_square
from sheath_manip.tasks.gauze_cutting.cutting.journal import Cut, make, make_again
from sheath_manip.tasks.gauze_cutting.cutting.locating import lie_of
from sheath_manip.tasks.gauze_cutting.cutting.sheet import NONE, Sheet
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
