"""A cut edge by edge, so that it can be made again on a sheet that has been made whole."""

from collections.abc import Iterable
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from sheath_manip.tasks.gauze_cutting.cutting.locating import Lie
from sheath_manip.tasks.gauze_cutting.cutting.severing import (
    Doubled,
    edge_between,
    require_spares,
    sever,
)
from sheath_manip.tasks.gauze_cutting.cutting.sheet import Sheet
from sheath_manip.tasks.gauze_cutting.cutting.snapping import snap


@dataclass(frozen=True)
class Cut:
    """The front of a cut moves from one vertex to the next."""

    start: int
    end: int
    """the same as `start` where a cut begins"""
    snapped_m: tuple[float, float] | None = None
    """where the vertex `end` was moved to, in material coordinates, before it was cut"""

    def row(self) -> NDArray[np.float64]:
        """Return the entry as (5,) plain numbers."""
        moved = self.snapped_m is not None
        return np.array([self.start, self.end, moved, *(self.snapped_m or (0.0, 0.0))])

    @classmethod
    def of(cls, row: NDArray) -> "Cut":
        """Return the entry of a `row()`."""
        moved = (float(row[3]), float(row[4])) if row[2] else None
        return cls(int(row[0]), int(row[1]), moved)


def make(sheet: Sheet, cut: Cut, data: mujoco.MjData, lie: Lie) -> list[Doubled]:
    """Cut a sheet in a running simulation, whose kinematics are up to date and stay so.

    `lie` is how the sheet lies, and follows. Raises SparesExhausted before anything has changed.
    """
    if cut.start != cut.end:
        require_spares(sheet)
    if cut.snapped_m is not None:
        _carry(sheet, cut.end, np.array(cut.snapped_m), data, lie)
    doubled = make_again(sheet, cut)
    for each in doubled:
        _set_position(sheet, each.copy, lie.positions_m[each.vertex], data, lie)
        own, copied = (sheet.dofs[vertex] + np.arange(3) for vertex in (each.vertex, each.copy))
        for array in (data.qvel, data.qacc_warmstart):
            array[copied] = array[own]
    return doubled


def make_again(sheet: Sheet, cut: Cut) -> list[Doubled]:
    """The model's part of a cut alone, for a simulation whose state is restored otherwise."""
    if cut.snapped_m is not None:
        snap(sheet, cut.end, np.array(cut.snapped_m))
    if cut.start == cut.end:
        return []
    edge = edge_between(sheet, cut.start, cut.end)
    assert edge is not None, f"no inner edge from vertex {cut.start} to {cut.end}"
    return sever(sheet, edge)


def rows_of(cuts: Iterable[Cut], longest: int) -> NDArray[np.float64]:
    """(longest, 5), the rest of it zero."""
    rows = np.zeros((longest, 5))
    for row, cut in zip(rows, cuts, strict=False):
        row[:] = cut.row()
    return rows


def _carry(sheet: Sheet, vertex: int, point_m: NDArray, data: mujoco.MjData, lie: Lie) -> None:
    """Put a vertex where the material that it is about to stand for is now."""
    place = lie.of(point_m)
    _set_position(sheet, vertex, place.world_m, data, lie)
    free = np.flatnonzero(~sheet.pinned[place.corners])
    columns = sheet.dofs[place.corners[free]][:, None] + np.arange(3)
    data.qvel[sheet.dofs[vertex] + np.arange(3)] = place.weights[free] @ data.qvel[columns]


def _set_position(
    sheet: Sheet, vertex: int, position_m: NDArray, data: mujoco.MjData, lie: Lie
) -> None:
    """Vertices slide along the axes of a body that does not turn."""
    body, start = sheet.bodies[vertex], sheet.coordinates[vertex]
    data.qpos[start : start + 3] += position_m - data.xpos[body]
    data.xpos[body] = lie.positions_m[vertex] = position_m
